/* Attitude filter: vectors of 3, matrices of 3 by 3 row by row, and packed covariances. */
#ifndef GD_ATTITUDE_MATRIX_H
#define GD_ATTITUDE_MATRIX_H

#include "attitude_state.h"

/* Smallest pivot of a covariance, and as a share of its diagonal: rounding may leave 0 or less, and a division must
   stay finite. */
#define GD_ATTITUDE_PIVOT GD_R(1e-30)
#define GD_ATTITUDE_PIVOT_SHARE (GD_IS_FLOAT ? GD_R(1e-6) : GD_R(1e-15))

#if defined(__SSE2__) || defined(__ARM_NEON)
#define GD_HAS_VECTOR_UNIT 1
#else
#define GD_HAS_VECTOR_UNIT 0
#endif
/* Length of a row of a covariance; filled up to whole vectors of 4 floats for a vector unit. */
#define GD_ATTITUDE_ROW (GD_ATTITUDE_STATES + 3 * GD_HAS_VECTOR_UNIT)

static inline gd_real gd_dot(const gd_real a[3], const gd_real b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Largest absolute component. */
static inline gd_real gd_largest(const gd_real v[3]) {
  return gd_max(gd_max(GD_ABS(v[0]), GD_ABS(v[1])), GD_ABS(v[2]));
}

static inline int gd_is_zero(const gd_real v[3]) {
  return !(v[0] < 0 || v[0] > 0 || v[1] < 0 || v[1] > 0 || v[2] < 0 || v[2] > 0);
}

/* Neither NaN nor infinite. */
static inline int gd_is_finite(gd_real x) { return x - x >= 0; }

static inline int gd_are_finite(const gd_real v[3]) {
  return gd_is_finite(v[0]) && gd_is_finite(v[1]) && gd_is_finite(v[2]);
}

/* Whether the absolute components are below a limit; a NaN is not. */
static inline int gd_are_below(const gd_real v[3], gd_real limit) {
  return GD_ABS(v[0]) < limit && GD_ABS(v[1]) < limit && GD_ABS(v[2]) < limit;
}

static inline void gd_cross(gd_real out[3], const gd_real a[3], const gd_real b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* out = m v. */
static inline void gd_times(gd_real out[3], const gd_real m[9], const gd_real v[3]) {
  int i;
  for (i = 0; i < 3; i++) {
    out[i] = gd_dot(&m[3 * i], v);
  }
}

/* Place of row i and column j in a packed covariance. */
static inline int gd_place(int i, int j) { return i <= j ? i * (41 - i) / 2 + j : j * (41 - j) / 2 + i; }

/* Row of a covariance, filled up with zeros. */
static inline void gd_row(gd_real out[GD_ATTITUDE_ROW], const gd_real *cov, int row) {
  int j, place = row;
  for (j = 0; j < GD_ATTITUDE_STATES; j++) {
    out[j] = cov[place];
    place += j < row ? GD_ATTITUDE_STATES - 1 - j : 1;
  }
  for (; j < GD_ATTITUDE_ROW; j++) {
    out[j] = 0;
  }
}

/* Sets the row of a covariance, and the column, which is the same. */
static inline void gd_set_row(gd_real *cov, int row, const gd_real values[GD_ATTITUDE_ROW]) {
  int j, place = row;
  for (j = 0; j < GD_ATTITUDE_STATES; j++) {
    cov[place] = values[j];
    place += j < row ? GD_ATTITUDE_STATES - 1 - j : 1;
  }
}

/* Block (3, 3) on the diagonal of a covariance. */
static inline void gd_diagonal_block(gd_real out[9], const gd_real *cov, int first) {
  int i, j;
  for (i = 0; i < 3; i++) {
    for (j = 0; j < 3; j++) {
      out[3 * i + j] = cov[gd_place(first + i, first + j)];
    }
  }
}

/* Add the same variance to three states. */
static inline void gd_add_variance(gd_real *cov, int first, gd_real variance) {
  int i;
  for (i = 0; i < 3; i++) {
    cov[gd_place(first + i, first + i)] += variance;
  }
}

/* Remove all that is known of a state, and give it this variance. */
static inline void gd_reset_state(gd_real *cov, int state, gd_real variance) {
  int i;
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    cov[gd_place(i, state)] = 0;
  }
  cov[gd_place(state, state)] = variance;
}

/* Forget a state whose variance is a difference of large floats, and negative. */
static inline void gd_repair(gd_real *cov) {
  int i;
  for (i = 0; GD_IS_FLOAT && i < GD_ATTITUDE_STATES; i++) {
    if (cov[gd_place(i, i)] < 0) {
      gd_reset_state(cov, i, GD_R(0.0));
    }
  }
}

static inline gd_real gd_pivot(gd_real pivot, gd_real variance) {
  return gd_max(gd_max(pivot, GD_ATTITUDE_PIVOT_SHARE * variance), GD_ATTITUDE_PIVOT);
}

/* s = l d l' of a symmetric matrix (3, 3): l has l[0] = l10, l[1] = l20, l[2] = l21. */
static inline void gd_factorize(gd_real l[3], gd_real d[3], const gd_real s[9]) {
  d[0] = gd_pivot(s[0], s[0]);
  l[0] = s[1] / d[0];
  l[1] = s[2] / d[0];
  d[1] = gd_pivot(s[4] - l[0] * s[1], s[4]);
  l[2] = (s[5] - l[1] * s[1]) / d[1];
  d[2] = gd_pivot(s[8] - l[1] * s[2] - l[2] * l[2] * d[1], s[8]);
}

/* Inverse of a covariance (3, 3), and the logarithm of its determinant where `log_det` is not null. */
static inline void gd_invert(gd_real out[9], gd_real *log_det, const gd_real s[9]) {
  gd_real l[3], d[3], m;
  gd_factorize(l, d, s);
  m = l[0] * l[2] - l[1];
  out[8] = GD_R(1.0) / d[2];
  out[5] = out[7] = -l[2] / d[2];
  out[2] = out[6] = m / d[2];
  out[4] = GD_R(1.0) / d[1] + l[2] * l[2] / d[2];
  out[1] = out[3] = -l[0] / d[1] - m * l[2] / d[2];
  out[0] = GD_R(1.0) / d[0] + l[0] * l[0] / d[1] + m * m / d[2];
  if (log_det) {
    *log_det = -(GD_LOG(d[0]) + GD_LOG(d[1]) + GD_LOG(d[2]));
  }
}

/* v' m v of a symmetric matrix (3, 3). */
static inline gd_real gd_quadratic(const gd_real m[9], const gd_real v[3]) {
  gd_real mv[3];
  gd_times(mv, m, v);
  return gd_dot(v, mv);
}

/* out = e s e', with the rows of e as new axes. */
static inline void gd_in_basis(gd_real out[9], const gd_real e[9], const gd_real s[9]) {
  gd_real es[9];
  int i, j, k;
  for (i = 0; i < 3; i++) {
    for (j = 0; j < 3; j++) {
      es[3 * i + j] = 0;
      for (k = 0; k < 3; k++) {
        es[3 * i + j] += e[3 * i + k] * s[3 * k + j];
      }
    }
  }
  for (i = 0; i < 3; i++) {
    for (j = 0; j < 3; j++) {
      out[3 * i + j] = gd_dot(&es[3 * i], &e[3 * j]);
    }
  }
}

#endif
