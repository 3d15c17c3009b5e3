/* Number type of the filters, its mathematics, sums without lost digits, and the limits of a sample.

   Everything is a `gd_real`: float, or what GD_REAL says. Times and their sums alone are doubles: where a block ends
   depends on the last digits. Where a double has the size of a float, as on AVR, use the functions that take
   microseconds.
*/
#ifndef GD_REAL_H
#define GD_REAL_H

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "gyrodrift.h needs NaN and the order of operations: compile without -ffast-math, -Ofast and their parts"
#endif

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef GD_REAL
#define GD_REAL float
#endif

typedef GD_REAL gd_real;
#ifdef __cplusplus
static_assert(gd_real(0.5) > gd_real(0) && sizeof(gd_real) <= sizeof(double), "GD_REAL must be float or double");
#else
_Static_assert(_Generic((gd_real)0, float: 1, double: 1, default: 0), "GD_REAL must be float or double");
#endif

#define GD_R(number) ((gd_real)(number))
#define GD_IS_FLOAT (sizeof(gd_real) == sizeof(float))

/* Mathematics in the type of the numbers. Only the function that is used is linked. */
#define GD_MATH(single, whole, x) (GD_IS_FLOAT ? (gd_real)single((float)(x)) : (gd_real)whole((double)(x)))
#define GD_MATH2(single, whole, x, y) \
  (GD_IS_FLOAT ? (gd_real)single((float)(x), (float)(y)) : (gd_real)whole((double)(x), (double)(y)))
#define GD_SQRT(x) GD_MATH(sqrtf, sqrt, x)
#define GD_EXP(x) GD_MATH(expf, exp, x)
#define GD_LOG(x) GD_MATH(logf, log, x)
#define GD_FLOOR(x) GD_MATH(floorf, floor, x)
#define GD_ABS(x) GD_MATH(fabsf, fabs, x)
#define GD_SIN(x) GD_MATH(sinf, sin, x)
#define GD_COS(x) GD_MATH(cosf, cos, x)
#define GD_ASIN(x) GD_MATH(asinf, asin, x)
#define GD_ACOS(x) GD_MATH(acosf, acos, x)
#define GD_ATAN2(y, x) GD_MATH2(atan2f, atan2, y, x)
#define GD_POW(x, y) GD_MATH2(powf, pow, x, y)

#define GD_PI GD_R(3.141592653589793)

/* Limits of a sample, far beyond every clock and gyro: their squares are finite floats. */
#define GD_MOST_S 1e15
#define GD_MOST_DPS GD_R(1e12)
#define GD_LEAST_STEP_S 1e-12

/* Longest step of a clock of 32 bits that is not in doubt: GD_POWER_CYCLE_S, the gap after which the bias is. */
#define GD_FAR_S 10.0
#define GD_FAR_US ((uint32_t)(GD_FAR_S * 1e6))

static inline gd_real gd_min(gd_real a, gd_real b) { return b < a ? b : a; }
static inline gd_real gd_max(gd_real a, gd_real b) { return b > a ? b : a; }

/* Adds to a sum. Of floats, it keeps the digits that the sum loses for the next addition (Kahan 1965): at 200 Hz a
   plain float loses up to a tenth of a slow turn once yaw has passed 1000 degrees. */
static inline void gd_add(gd_real *sum, gd_real *lost, gd_real x) {
  const gd_real whole = x + *lost;
  const gd_real total = *sum + whole;
  *lost = GD_IS_FLOAT ? whole - (total - *sum) : GD_R(0.0);
  *sum = total;
}

/* Counts, and stays at the largest number. */
static inline void gd_count(uint32_t *count) {
  if (*count < UINT32_MAX) {
    ++*count;
  }
}

/* Whether a sample is within the limits; a NaN is not. */
static inline int gd_is_within(double t_s, gd_real rate_dps) {
  return -GD_MOST_S <= t_s && t_s <= GD_MOST_S && -GD_MOST_DPS <= rate_dps && rate_dps <= GD_MOST_DPS;
}

/* Step of a clock of 32 bits in s, which wraps; 0 if the sample is refused, and below 0 if it waits for the next one.

   A stamp that goes back or far ahead may be damaged, or the samples had a pause of which a clock that wraps does not
   know the length. The next stamp decides: if it follows that stamp there was a gap, else that stamp alone is left out.
   `suspect_us` keeps the stamp meanwhile; else it is `before_us`. */
static inline double gd_step_of_us(uint32_t t_us, uint32_t before_us, uint32_t *suspect_us) {
  const uint32_t step_us = t_us - before_us, after_us = t_us - *suspect_us;
  if (step_us > GD_FAR_US && (*suspect_us == before_us || after_us == 0 || after_us >= 0x80000000UL)) {
    *suspect_us = t_us;
    return step_us < 0x80000000UL ? -1.0 : 0.0;
  }
  return (double)step_us * 1e-6;
}

#endif
