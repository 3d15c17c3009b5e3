/* Attitude filter: levelling of the attitude by the mean acceleration of the first blocks. */
#ifndef GD_ATTITUDE_LEVELLING_H
#define GD_ATTITUDE_LEVELLING_H

#include "attitude_hypotheses.h"

/* Standard deviation of the tilt at the first sample, and before the first acceleration, rad. */
#define GD_ATTITUDE_START_TILT (GD_R(4.0) * GD_ATTITUDE_RAD)
#define GD_ATTITUDE_UNKNOWN_TILT (GD_R(30.0) * GD_ATTITUDE_RAD)
/* Rate above which the first block is a motion, rad/s, and the standard deviation of its tilt, rad. */
#define GD_ATTITUDE_START_RATE (GD_R(3.0) * GD_ATTITUDE_RAD)
#define GD_ATTITUDE_MOVING_TILT (GD_R(12.0) * GD_ATTITUDE_RAD)
/* Standard deviation of the tilt from which on the next accelerations level it, deg. */
#define GD_ATTITUDE_LOST_TILT_DEG GD_R(15.0)
/* Averaging time of the specific force, s; squared slope (30 deg) of its mean beyond which the tilt is lost, with a
   margin for free fall, (m/s^2)^2. */
#define GD_ATTITUDE_MEAN_FORCE_S GD_R(5.0)
#define GD_ATTITUDE_LOST_SLOPE GD_R(1.0 / 3.0)
#define GD_ATTITUDE_LEAST_SQUARED GD_R(10.0)
/* Standard deviation of what a lost tilt has done to the biases, deg/s. */
#define GD_ATTITUDE_LOST_BIAS GD_R(0.3)
/* Time whose mean acceleration levels the attitude, s. */
#define GD_ATTITUDE_LEVELLING_S 0.3

/* Give the tilt of all hypotheses this standard deviation, rad. */
static inline void gd_attitude_reset_tilt(gd_attitude *a, gd_real sigma) {
  int i;
  for (i = 0; i < a->sum.count; i++) {
    gd_reset_state(gd_attitude_at(a, i)->cov, 0, sigma * sigma);
    gd_reset_state(gd_attitude_at(a, i)->cov, 1, sigma * sigma);
  }
}

/* Begin levelling again, with the tilt of a first sample. */
static inline void gd_attitude_restart(gd_attitude *a) {
  a->motion.level_s = 0;
  memset(a->motion.level_force, 0, sizeof a->motion.level_force);
  gd_attitude_reset_tilt(a, GD_ATTITUDE_START_TILT);
}

/* Widen the tilt where the first block is a motion. */
static inline void gd_attitude_widen_tilt(gd_attitude *a) {
  const gd_real least = GD_ATTITUDE_MOVING_TILT * GD_ATTITUDE_MOVING_TILT;
  int i;
  for (i = 0; i < a->sum.count; i++) {
    gd_real *cov = gd_attitude_at(a, i)->cov;
    cov[gd_place(0, 0)] = gd_max(cov[gd_place(0, 0)], least);
    cov[gd_place(1, 1)] = gd_max(cov[gd_place(1, 1)], least);
  }
}

/* Turn all hypotheses so that the mean specific force since the first acceleration is vertical. */
static inline void gd_attitude_level_start(gd_attitude *a, const gd_attitude_integrals *block) {
  gd_attitude_motion *m = &a->motion;
  gd_real force[3], turn[4];
  int i, k;
  if (a->tilt_sigma_deg > GD_ATTITUDE_LOST_TILT_DEG) {
    gd_attitude_restart(a);
  }
  if (m->level_s >= GD_ATTITUDE_LEVELLING_S - 1e-9) {
    return;
  }
  if (!(m->level_s > 0) && gd_largest(block->gyro) > GD_ATTITUDE_START_RATE) {
    gd_attitude_widen_tilt(a);
  }
  gd_rotate(force, a->start_q, block->velocity);
  for (k = 0; k < 3; k++) {
    force[k] += m->level_force[k];
  }
  gd_level(turn, force);
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    gd_product(h->q, turn, h->q);
    gd_make_unit(h->q);
    memset(h->velocity, 0, sizeof h->velocity);
  }
  m->level_s += a->block.seconds;
  gd_rotate(m->level_force, turn, force);
}

/* Begin levelling again if the mean specific force of the last seconds is far from the vertical. */
static inline void gd_attitude_find_lost_tilt(gd_attitude *a, const gd_attitude_integrals *block) {
  const gd_real share = gd_min(GD_R(1.0), block->seconds / GD_ATTITUDE_MEAN_FORCE_S);
  gd_real *mean = a->motion.mean_force, force[3];
  int i;
  for (i = 0; i < 3; i++) {
    force[i] = block->velocity[i] / block->seconds;
  }
  gd_rotate(force, a->start_q, force);
  for (i = 0; i < 3; i++) {
    mean[i] += share * (force[i] - mean[i]);
  }
  if (mean[0] * mean[0] + mean[1] * mean[1] >
      GD_ATTITUDE_LOST_SLOPE * mean[2] * GD_ABS(mean[2]) + GD_ATTITUDE_LEAST_SQUARED) {
    const gd_real lost = GD_ATTITUDE_LOST_BIAS * GD_ATTITUDE_RAD;
    gd_attitude_restart(a);
    mean[0] = mean[1] = 0;
    mean[2] = GD_ATTITUDE_GRAVITY;
    gd_attitude_reset_tilt(a, GD_ATTITUDE_MOVING_TILT);
    for (i = 0; i < a->sum.count; i++) {
      gd_add_variance(gd_attitude_at(a, i)->cov, GD_ATTITUDE_BIAS, lost * lost);
    }
  }
}

#endif
