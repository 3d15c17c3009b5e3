/* Attitude filter: update of all hypotheses at the end of a block, and the estimate that results. */
#ifndef GD_ATTITUDE_UPDATE_H
#define GD_ATTITUDE_UPDATE_H

#include "attitude_aided.h"
#include "attitude_block.h"
#include "attitude_knowledge.h"
#include "attitude_levelling.h"
#include "attitude_predict.h"
#include "attitude_segments.h"
#include "attitude_velocity.h"

/* Standard deviation of the bias of an accelerometer, m/s^2. */
#define GD_ATTITUDE_FORCE_BIAS_SIGMA GD_R(0.3)
/* Standard deviation of the change of a bias by gravity, rad/s per g. */
#define GD_ATTITUDE_G_SENSITIVITY (GD_R(0.05) * GD_ATTITUDE_RAD)

/* Yaw with its whole turns: the hypotheses keep theirs next to 0, where float has its digits. */
static inline void gd_attitude_set_heading(gd_attitude *a, gd_real heading_deg) {
  a->heading_deg = heading_deg;
  a->yaw_deg = (gd_real)a->turns * GD_R(360.0) + heading_deg;
}

/* Move whole turns of the headings into the state's count. */
static inline void gd_attitude_count_turns(gd_attitude *a) {
  const gd_real turns = GD_FLOOR(gd_attitude_at(a, 0)->yaw_deg / GD_R(360.0) + GD_R(0.5));
  int i;
  if (GD_ABS(turns) < 1 || !(GD_ABS((gd_real)a->turns + turns) < GD_R(2e9))) {
    return;
  }
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_at(a, i)->yaw_deg -= GD_R(360.0) * turns;
  }
  a->turns += (int32_t)turns;
}

/* Write the Gaussian sum as the estimate of the last sample. */
static inline void gd_attitude_publish(gd_attitude *a) {
  const gd_attitude_hypothesis *first = gd_attitude_at(a, 0);
  gd_attitude_moments m;
  gd_real turn[4] = {0, 0, 0, 0}, axis[3];
  int i;
  gd_attitude_moments_of(&m, &a->sum);
  turn[0] = GD_COS(GD_R(0.5) * m.heading);
  turn[3] = GD_SIN(GD_R(0.5) * m.heading);
  gd_product(a->q, turn, first->q);
  memcpy(a->start_q, a->q, sizeof a->q);
  a->start_deg = first->yaw_deg + m.heading / GD_ATTITUDE_RAD;
  gd_attitude_set_heading(a, a->start_deg);
  a->yaw_sigma_deg = GD_SQRT(gd_max(m.heading_var, 0)) / GD_ATTITUDE_RAD;
  a->tilt_sigma_deg = GD_SQRT(gd_max(m.tilt_var, 0)) / GD_ATTITUDE_RAD;
  gd_heading_axis(axis, a->q);
  a->bias_dps = gd_dot(axis, m.bias) / GD_ATTITUDE_RAD;
  a->heading_rate_dps = gd_dot(axis, a->gyro_dps);
  a->bias_sigma_dps = GD_SQRT(gd_max(gd_quadratic(m.bias_cov, axis), 0)) / GD_ATTITUDE_RAD;
  a->rest_probability = 0;
  for (i = 0; i < 3; i++) {
    a->bias_xyz_dps[i] = m.bias[i] / GD_ATTITUDE_RAD;
    a->bias_sigma_xyz_dps[i] = GD_SQRT(gd_max(m.bias_cov[4 * i], 0)) / GD_ATTITUDE_RAD;
  }
  for (i = 0; a->segment.blocks > 0 && i < a->sum.count; i++) {
    a->rest_probability += gd_attitude_at(a, i)->regime == GD_ATTITUDE_REST ? gd_attitude_at(a, i)->weight : GD_R(0.0);
  }
  a->confidence = first->weight;
  a->tilt_deg = gd_tilt_deg(a->q);
}

/* Covariance of the first hypothesis. */
static inline void gd_attitude_first_covariance(const gd_attitude *a, gd_real *cov, gd_real tilt) {
  const gd_attitude_coefficients *c = &a->c;
  const gd_real yaw = a->yaw_sigma_deg * GD_ATTITUDE_RAD;
  int i;
  cov[gd_place(0, 0)] = cov[gd_place(1, 1)] = tilt * tilt;
  cov[gd_place(GD_ATTITUDE_HEADING, GD_ATTITUDE_HEADING)] = yaw * yaw;
  gd_add_variance(cov, GD_ATTITUDE_BIAS, c->bias_sigma * c->bias_sigma);
  gd_add_variance(cov, GD_ATTITUDE_VELOCITY, GD_ATTITUDE_START_SPEED * GD_ATTITUDE_START_SPEED);
  gd_add_variance(cov, GD_ATTITUDE_FORCE_BIAS, GD_ATTITUDE_FORCE_BIAS_SIGMA * GD_ATTITUDE_FORCE_BIAS_SIGMA);
  for (i = 0; i < 9; i++) {
    const gd_real sigma = i % 4 == 0 ? c->scale_sigma : c->cross_sigma;
    cov[gd_place(GD_ATTITUDE_SCALE + i, GD_ATTITUDE_SCALE + i)] = sigma * sigma;
  }
}

/* First sample: level by its acceleration; heading and sigma are 0 unless they were set before. */
static inline void gd_attitude_begin(gd_attitude *a, const gd_real accel[3]) {
  const gd_real zero[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, half = GD_R(0.5) * a->yaw_deg * GD_ATTITUDE_RAD;
  const int has_accel = gd_are_finite(accel);
  const gd_real turn[4] = {GD_COS(half), 0, 0, GD_SIN(half)};
  gd_real q[4];
  gd_attitude_first_hypothesis(&a->sum);
  gd_identity(q);
  if (has_accel) {
    gd_level(q, accel);
  }
  gd_product(a->sum.slot[0].q, turn, q);
  a->sum.slot[0].yaw_deg = a->yaw_deg;
  a->turns = 0;
  gd_attitude_count_turns(a);
  gd_attitude_first_covariance(a, a->sum.slot[0].cov, has_accel ? GD_ATTITUDE_START_TILT : GD_ATTITUDE_UNKNOWN_TILT);
  a->noise_var = GD_ATTITUDE_GYRO_NOISE * GD_ATTITUDE_GYRO_NOISE;
  gd_attitude_begin_remembered(a);
  gd_attitude_next_block(&a->block, zero, zero);
  gd_attitude_publish(a);
}

/* Whether a hypothesis of a quiet rest has a bias that this block does not leave: the device has not begun to move. */
static inline int gd_attitude_is_standing(const gd_attitude *a, const gd_attitude_hypothesis *h,
                                          const gd_attitude_integrals *block) {
  gd_real off[3];
  int i;
  for (i = 0; i < 3; i++) {
    off[i] = block->gyro[i] - h->bias[i];
  }
  return a->segment.blocks == GD_ATTITUDE_QUIET_BLOCKS && h->regime == GD_ATTITUDE_REST &&
         gd_largest(off) < a->c.limits * GD_ATTITUDE_GYRO_SPREAD;
}

/* Widen the biases as gravity moves in the sensor, farther than it was since the last rest. */
static inline void gd_attitude_widen_by_tilt(gd_attitude *a) {
  gd_attitude_motion *m = &a->motion;
  gd_real up[3], moved[3], moved_var;
  int i;
  gd_up_in_sensor(up, gd_attitude_at(a, 0)->q);
  if (a->rest_probability > GD_MAJORITY || gd_is_zero(m->rest_up)) {
    memcpy(m->rest_up, up, sizeof up);
    m->moved_var = 0;
  }
  for (i = 0; i < 3; i++) {
    moved[i] = up[i] - m->rest_up[i];
  }
  moved_var = gd_dot(moved, moved);
  if (moved_var > m->moved_var) {
    const gd_real added = GD_ATTITUDE_G_SENSITIVITY * GD_ATTITUDE_G_SENSITIVITY * (moved_var - m->moved_var);
    for (i = 0; i < a->sum.count; i++) {
      gd_add_variance(gd_attitude_at(a, i)->cov, GD_ATTITUDE_BIAS, added);
    }
    m->moved_var = moved_var;
  }
}

/* Widen the biases in motion, which differ from those at rest, for the first seconds. A slow turn is no motion. */
static inline void gd_attitude_widen_by_motion(gd_attitude *a, gd_real seconds) {
  const gd_real rate = GD_ATTITUDE_REST_BIAS * GD_ATTITUDE_REST_BIAS / GD_MAX_RAMP_S;
  int i;
  if (gd_attitude_left_gradually(a)) {
    return;
  }
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    const int is_at_rest = h->regime == GD_ATTITUDE_REST && a->segment.blocks > 0;
    if (h->knows_bias && h->moving_s < GD_MAX_RAMP_S && !is_at_rest) {
      gd_add_variance(h->cov, GD_ATTITUDE_BIAS, rate * seconds);
    }
  }
}

/* Carry hypothesis `i` over the block. The first one is the reference: the block has its bias and scale. */
static inline void gd_attitude_predict_one(gd_attitude *a, gd_attitude_job *job, int i) {
  gd_attitude_hypothesis *h = gd_attitude_at(a, i);
  gd_attitude_integrals usable = job->block;
  const int is_held = gd_attitude_is_standing(a, h, &usable);
  memcpy(usable.velocity, job->usable_velocity, sizeof usable.velocity);
  usable.by_bias = a->block.by_bias;
  usable.by_scale = a->block.by_scale;
  h->yaw_deg += is_held ? GD_R(0.0) : job->heading_deg - a->start_deg;
  gd_attitude_predict(&job->transition, h, gd_attitude_at(a, 0), &usable, is_held);
}

/* Whether all hypotheses are numbers, with biases that a gyro may have. */
static inline int gd_attitude_is_whole(gd_attitude *a) {
  int i, k, is_whole = 1;
  for (i = 0; i < a->sum.count; i++) {
    const gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    gd_real total = h->weight + h->q[0] + h->q[1] + h->q[2] + h->q[3] + h->yaw_deg;
    for (k = 0; k < GD_ATTITUDE_STATES; k++) {
      total += gd_attitude_variance(h, k);
    }
    is_whole = is_whole && gd_is_finite(total) && gd_are_finite(h->velocity) &&
               gd_are_below(h->bias, GD_ATTITUDE_FASTEST_DPS * GD_ATTITUDE_RAD);
  }
  return is_whole;
}

/* Begin again at the last yaw, of which nothing more is known: damaged samples have made the numbers infinite. */
static inline void gd_attitude_begin_again(gd_attitude *a, gd_real heading_deg) {
  const int32_t turns = a->turns;
  memset(&a->windows, 0, sizeof a->windows);
  memset(&a->segment, 0, sizeof a->segment);
  memset(&a->motion, 0, sizeof a->motion);
  a->motion.mean_force[2] = GD_ATTITUDE_GRAVITY;
  a->yaw_deg = heading_deg;
  a->yaw_sigma_deg = GD_R(180.0);
  gd_attitude_begin(a, a->accel_mps2);
  a->turns += turns;
  gd_attitude_set_heading(a, a->heading_deg);
}

#endif
