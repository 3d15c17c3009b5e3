/* Attitude filter: Kalman updates of a hypothesis by three states that are measured directly. */
#ifndef GD_ATTITUDE_MEASURE_H
#define GD_ATTITUDE_MEASURE_H

#include "attitude_hypotheses.h"

/* Largest squared distance that counts in a likelihood: beyond it, no model of the motion holds. */
#define GD_ATTITUDE_MOST_SQUARED GD_R(25.0)

/* A measurement of three combinations of states.

   carried: covariances (21, 3) of all states with the three. spread, inverse: covariance of the innovation, and its
   inverse. off: the innovation. gain: of the Kalman filter (21, 3). */
typedef struct {
  gd_real carried[GD_ATTITUDE_STATES][3], gain[GD_ATTITUDE_STATES][3];
  gd_real spread[9], inverse[9], off[3], log_det;
} gd_attitude_innovation;

/* Measured errors (3) of three states with a covariance (3, 3), about the error states so far (21). */
static inline void gd_attitude_innovate(gd_attitude_innovation *m, const gd_real *cov, const gd_real *error, int first,
                                        const gd_real values[3], const gd_real variance[9]) {
  int i, j;
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    for (j = 0; j < 3; j++) {
      m->carried[i][j] = cov[gd_place(i, first + j)];
    }
  }
  gd_diagonal_block(m->spread, cov, first);
  for (i = 0; i < 9; i++) {
    m->spread[i] += variance[i];
  }
  for (i = 0; i < 3; i++) {
    m->off[i] = values[i] - error[first + i];
  }
}

/* Use the rows of `basis` (3, 3) as the three combinations; add `free` to the variance of the last one. */
static inline void gd_attitude_turn_basis(gd_attitude_innovation *m, const gd_real basis[9], gd_real unknown_var) {
  gd_real turned[9], off[3], row[3];
  int i;
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    gd_times(row, basis, m->carried[i]);
    memcpy(m->carried[i], row, sizeof row);
  }
  gd_in_basis(turned, basis, m->spread);
  memcpy(m->spread, turned, sizeof turned);
  m->spread[8] += unknown_var;
  gd_times(off, basis, m->off);
  memcpy(m->off, off, sizeof off);
}

/* Inverse of the spread and gains, once the innovation is complete. */
static inline void gd_attitude_set_gains(gd_attitude_innovation *m) {
  int i;
  gd_invert(m->inverse, &m->log_det, m->spread);
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    gd_times(m->gain[i], m->inverse, m->carried[i]);
  }
}

/* Update the error states and the covariance by the innovation. */
static inline void gd_attitude_measure(gd_attitude_innovation *m, gd_real *cov, gd_real *error) {
  gd_real *entry = cov;
  int i, j;
  gd_attitude_set_gains(m);
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    error[i] += gd_dot(m->gain[i], m->off);
    for (j = i; j < GD_ATTITUDE_STATES; j++) {
      *entry++ -= gd_dot(m->gain[i], m->carried[j]);
    }
  }
  gd_repair(cov);
}

/* Take the share 1 - `share` of three gains along the unit vector `up` away; `lost` gets it. */
static inline void gd_attitude_lose(gd_attitude_innovation *m, gd_real lost[][3], int first, int stride,
                                    const gd_real up[3], gd_real share) {
  int i, j;
  for (j = 0; j < 3; j++) {
    gd_real along = 0;
    for (i = 0; i < 3; i++) {
      along += up[i] * m->gain[first + stride * i][j];
    }
    for (i = 0; i < 3; i++) {
      lost[first + stride * i][j] = (GD_R(1.0) - share) * up[i] * along;
    }
  }
}

/* Update with a share of the gains about the vertical `up` in the sensor: of heading, bias and scale. The covariance
   stays true. It is the one of Joseph's form, written as that of all gains and a positive part for the lost ones. */
static inline void gd_attitude_measure_in_part(gd_attitude_innovation *m, gd_real *cov, gd_real *error,
                                               const gd_real up[3], gd_real share) {
  gd_real lost[GD_ATTITUDE_STATES][3], spread_lost[3];
  gd_real *entry = cov;
  int i, j;
  memset(lost, 0, sizeof lost);
  gd_attitude_measure(m, cov, error);
  for (j = 0; j < 3; j++) {
    lost[GD_ATTITUDE_HEADING][j] = (GD_R(1.0) - share) * m->gain[GD_ATTITUDE_HEADING][j];
    gd_attitude_lose(m, lost, GD_ATTITUDE_SCALE + j, 3, up, share);
  }
  gd_attitude_lose(m, lost, GD_ATTITUDE_BIAS, 1, up, share);
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    if (gd_is_zero(lost[i])) {
      entry += GD_ATTITUDE_STATES - i;
      continue;
    }
    error[i] -= gd_dot(lost[i], m->off);
    gd_times(spread_lost, m->spread, lost[i]);
    for (j = i; j < GD_ATTITUDE_STATES; j++) {
      *entry++ += gd_dot(spread_lost, lost[j]);
    }
  }
}

/* Squared distance of the innovation, in its standard deviations. */
static inline gd_real gd_attitude_squared(const gd_attitude_innovation *m) { return gd_quadratic(m->inverse, m->off); }

/* Logarithm of the likelihood but for a constant. */
static inline gd_real gd_attitude_log_likelihood(const gd_attitude_innovation *m) {
  return GD_R(0.5) * (m->log_det - gd_min(gd_attitude_squared(m), GD_ATTITUDE_MOST_SQUARED));
}

/* Widen all that the bias carries: its covariances with the heading grow too. */
static inline void gd_attitude_widen_part(gd_real *cov, gd_real factor) {
  gd_real carried[GD_ATTITUDE_STATES][3], block[9], inverse[9], gain[3];
  gd_real *entry = cov;
  int i, j;
  gd_diagonal_block(block, cov, GD_ATTITUDE_BIAS);
  gd_invert(inverse, 0, block);
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    for (j = 0; j < 3; j++) {
      carried[i][j] = cov[gd_place(i, GD_ATTITUDE_BIAS + j)];
    }
  }
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    gd_times(gain, inverse, carried[i]);
    for (j = i; j < GD_ATTITUDE_STATES; j++) {
      *entry++ += (factor - GD_R(1.0)) * gd_dot(gain, carried[j]);
    }
  }
}

/* Widen the bias of a hypothesis whose rest is more than 3 sigma away in a component. Before the first rest the part is
   a raw one. Later the bias has jumped. */
static inline void gd_attitude_widen(gd_attitude_hypothesis *h, const gd_real off[3], const gd_real variance[3]) {
  gd_real factor = 1;
  int i, is_far = 0;
  for (i = 0; i < 3; i++) {
    const gd_real spread = h->cov[gd_place(GD_ATTITUDE_BIAS + i, GD_ATTITUDE_BIAS + i)];
    is_far = is_far || off[i] * off[i] > GD_R(9.0) * (spread + variance[i]);
    factor = gd_max(factor, off[i] * off[i] / gd_max(GD_R(9.0) * spread, GD_ATTITUDE_PIVOT));
  }
  if (!is_far) {
    return;
  }
  if (h->knows_bias) {
    for (i = 0; i < 3; i++) {
      h->cov[gd_place(GD_ATTITUDE_BIAS + i, GD_ATTITUDE_BIAS + i)] += off[i] * off[i];
    }
  } else {
    gd_attitude_widen_part(h->cov, factor);
  }
}

#endif
