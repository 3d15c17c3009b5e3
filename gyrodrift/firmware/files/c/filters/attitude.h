/* Attitude and heading from three gyro axes and an accelerometer, and how sure they are.

   The same filter as gyrodrift/filters/attitude: a Gaussian sum of error-state Kalman filters. docs/attitude.md has the
   equations. Of doubles, it gives the same yaw within 1e-9 deg.
*/
#ifndef GD_ATTITUDE_H
#define GD_ATTITUDE_H

#include "attitude_gap.h"
#include "attitude_spikes.h"

/* Accelerations above this are no measurements, m/s^2. */
#define GD_ATTITUDE_LARGEST_MPS2 GD_R(4000.0)
/* Equal accelerations in a row above this are the end of a range, m/s^2: the smallest range is 2 g. */
#define GD_ATTITUDE_CLIPPED_MPS2 GD_R(18.0)
/* Time for which an acceleration holds, s: an accelerometer may be slower than the gyro. */
#define GD_ATTITUDE_HOLD_S 0.1
/* Longest time between two samples as a number of the filter, s: its turn is unknown long before. */
#define GD_ATTITUDE_LONGEST_GAP_S 1e6

/* Begin; 0 if a parameter was out of bounds: the defaults stand in its place. NULL: all defaults. */
static inline int gd_attitude_init(gd_attitude *a, const gd_restlevel_params *params) {
  const gd_restlevel_params defaults = GD_RESTLEVEL_DEFAULTS;
  const int is_valid = params == 0 || gd_restlevel_params_are_valid(params);
  memset(a, 0, sizeof *a);
  a->c = gd_attitude_coefficients_of(params != 0 && is_valid ? params : &defaults);
  a->q[0] = 1;
  a->confidence = 1;
  a->tilt_sigma_deg = 180;
  a->accel_t_s = -1e30;
  a->accel_mps2[0] = a->accel_mps2[1] = a->accel_mps2[2] = (gd_real)NAN;
  a->witness.is_believed = 1;
  a->longest_step_s = GD_FIRST_STEP_S;
  a->motion.mean_force[2] = GD_ATTITUDE_GRAVITY;
  return is_valid;
}

/* Whether an acceleration equals the one before at the end of its range. */
static inline int gd_attitude_is_clipped(const gd_real accel[3], const gd_real before[3]) {
  int i;
  for (i = 0; i < 3; i++) {
    if (GD_ABS(accel[i]) > GD_ATTITUDE_CLIPPED_MPS2 && accel[i] >= before[i] && accel[i] <= before[i]) {
      return 1;
    }
  }
  return 0;
}

/* Take the acceleration of a sample: the last one holds for a short time, then NaN. Three zeros are none: noise is
   missing. */
static inline void gd_attitude_take_accel(gd_attitude *a, double t_s, const gd_real accel[3]) {
  const gd_real size = gd_dot(accel, accel);
  if (size > 0 && size < GD_ATTITUDE_LARGEST_MPS2 * GD_ATTITUDE_LARGEST_MPS2) {
    if (size > GD_ATTITUDE_CLIPPED_MPS2 * GD_ATTITUDE_CLIPPED_MPS2 && gd_attitude_is_clipped(accel, a->accel_mps2)) {
      a->block.is_clipped = 1;
    }
    memcpy(a->accel_mps2, accel, sizeof a->accel_mps2);
    a->accel_t_s = t_s;
  } else if (!(t_s - a->accel_t_s <= GD_ATTITUDE_HOLD_S)) {
    a->accel_mps2[0] = a->accel_mps2[1] = a->accel_mps2[2] = (gd_real)NAN;
  }
}

/* Turn the block and the output by the mean of this sample and the one before. */
static inline void gd_attitude_turn(gd_attitude *a, double dt_s, const gd_real gyro[3], const gd_real before[3]) {
  const int has_before = gd_are_finite(before);
  gd_real rate[3], accel[3], axis[3], dt;
  dt = (gd_real)dt_s;
  gd_attitude_mean_rate(rate, a, dt, gyro);
  gd_attitude_middle(accel, a->accel_mps2, has_before ? before : a->accel_mps2);
  gd_attitude_add_sample(&a->block, dt_s, rate, accel);
  gd_product(a->q, a->start_q, a->block.q);
  gd_heading_axis(axis, a->q);
  a->heading_rate_dps = gd_dot(axis, a->gyro_dps);
  a->tilt_deg = gd_tilt_deg(a->q);
  gd_attitude_set_heading(a, gd_unwrapped_deg(a->heading_deg + (a->heading_rate_dps - a->bias_dps) * dt, a->q));
}

/* Stores a step of yaw that is no motion, and counts it if it is large. */
static inline void gd_attitude_count_correction(gd_attitude *a, gd_real heading_deg, int32_t turns) {
  a->correction_deg = a->heading_deg - heading_deg + GD_R(360.0) * (gd_real)(a->turns - turns);
  if (GD_ABS(a->correction_deg) > GD_CORRECTION_DEG && a->corrections < UINT16_MAX) {
    ++a->corrections;
  }
}

/* Take an accepted sample that comes dt_s after the last one. */
static inline void gd_attitude_advance(gd_attitude *a, double t_s, double dt_s, const gd_real gyro[3],
                                       const gd_real accel[3], gd_real still) {
  gd_real before[3], heading_deg = a->heading_deg;
  int32_t turns = a->turns;
  memcpy(before, a->accel_mps2, sizeof before);
  gd_attitude_take_accel(a, t_s, accel);
  a->correction_deg = 0;
  if (a->samples == 0) {
    memcpy(a->gyro_dps, gyro, sizeof a->gyro_dps);
    gd_attitude_begin(a, a->accel_mps2);
  } else if (dt_s > a->longest_step_s) {
    gd_attitude_pass_gap(a, dt_s, gyro);
    gd_attitude_count_correction(a, heading_deg, turns);
  } else {
    gd_attitude_turn(a, dt_s, gyro, before);
  }
  gd_count(&a->samples);
  a->t_s = t_s;
  a->block.still += still >= 1 && still <= 1;
  a->block.moving += still < 1 || still > 1;
  if (a->block.seconds >= a->c.block_s - 1e-9 && a->block.samples >= 2) {
    heading_deg = a->heading_deg;
    turns = a->turns;
    a->longest_step_s = gd_longest_step_s(a->block.seconds / (double)a->block.samples);
    gd_attitude_end_block(a);
    gd_attitude_count_correction(a, heading_deg, turns);
  }
}

/* Whether a sample is taken; else it is counted. `dt_s` is the step from the sample before; after a restart the clock
   may have restarted too. */
static inline int gd_attitude_accepts(gd_attitude *a, double t_s, double *dt_s, const gd_real gyro[3]) {
  const int is_usable = t_s - t_s >= 0.0 && gd_are_below(gyro, GD_ATTITUDE_FASTEST_DPS);
  if (is_usable && a->longest_step_s < GD_TOLD_GAP && !(*dt_s > 0.0)) {
    *dt_s = GD_LEAST_STEP_S;
    a->accel_t_s = t_s;
  }
  if (is_usable && (a->samples == 0 || *dt_s > 0.0)) {
    return 1;
  }
  gd_count(&a->rejected);
  return 0;
}

/* Takes a sample: device time in s, rates in deg/s, specific force in m/s^2 (NaN: missing). `still` is 1 at rest and 0
   in motion by an external sensor; `temp_c` has no effect so far. Both are NaN if unknown.

   Returns 0 if the sample is refused: time stands still or goes back, or time or a rate is not finite or out of range.
*/
static inline int gd_attitude_update_with(gd_attitude *a, double t_s, const gd_real gyro_dps[3],
                                          const gd_real accel_mps2[3], gd_real still, gd_real temp_c) {
  double dt_s = t_s - a->t_s;
  (void)temp_c;
  if (!gd_attitude_accepts(a, t_s, &dt_s, gyro_dps)) {
    return 0;
  }
  gd_attitude_advance(a, t_s, dt_s < GD_ATTITUDE_LONGEST_GAP_S ? dt_s : GD_ATTITUDE_LONGEST_GAP_S, gyro_dps, accel_mps2,
                      still);
  return 1;
}

/* Takes a sample without a rest sensor and a temperature. */
static inline int gd_attitude_update(gd_attitude *a, double t_s, const gd_real gyro_dps[3],
                                     const gd_real accel_mps2[3]) {
  return gd_attitude_update_with(a, t_s, gyro_dps, accel_mps2, (gd_real)NAN, (gd_real)NAN);
}

/* The same by a clock of microseconds that wraps, as micros() of Arduino. Use one of the clocks. */
static inline int gd_attitude_update_us_with(gd_attitude *a, uint32_t t_us, const gd_real gyro_dps[3],
                                             const gd_real accel_mps2[3], gd_real still, gd_real temp_c) {
  const double step_s = a->samples > 0 ? gd_step_of_us(t_us, a->t_us, &a->suspect_us) : 0.0;
  const int waits = step_s < 0.0 && !(a->longest_step_s < GD_TOLD_GAP);
  double dt_s = waits ? GD_LEAST_STEP_S : step_s;
  (void)temp_c;
  if (!gd_attitude_accepts(a, 0.0, &dt_s, gyro_dps)) {
    return 0;
  }
  if (waits) {
    gd_count(&a->samples);
    a->correction_deg = 0;
    return 1;
  }
  a->t_us = a->suspect_us = t_us;
  gd_attitude_advance(a, a->t_s + dt_s, dt_s, gyro_dps, accel_mps2, still);
  return 1;
}

static inline int gd_attitude_update_us(gd_attitude *a, uint32_t t_us, const gd_real gyro_dps[3],
                                        const gd_real accel_mps2[3]) {
  return gd_attitude_update_us_with(a, t_us, gyro_dps, accel_mps2, (gd_real)NAN, (gd_real)NAN);
}

#endif
