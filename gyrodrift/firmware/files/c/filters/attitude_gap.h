/* Attitude filter: a gap in the samples. Twin of attitude/gap.py. */
#ifndef GD_ATTITUDE_GAP_H
#define GD_ATTITUDE_GAP_H

#include "attitude_update.h"

/* Variances of the unknown turn in a gap, rad^2: about each level axis, and about the vertical. */
static inline void gd_attitude_turn_variances(gd_real out[3], const gd_attitude *a, gd_real seconds,
                                              const gd_real gyro[3]) {
  gd_real rates[3], axis[3], heading_dps, level_dps;
  int i;
  for (i = 0; i < 3; i++) {
    rates[i] = gyro[i] + a->gyro_dps[i] - GD_R(2.0) * a->bias_xyz_dps[i];
  }
  gd_heading_axis(axis, a->q);
  heading_dps = gd_dot(axis, rates);
  level_dps = GD_SQRT(gd_max(GD_R(0.0), gd_dot(rates, rates) - heading_dps * heading_dps));
  out[0] = out[1] = GD_ATTITUDE_RAD * GD_ATTITUDE_RAD * gd_turn_var(seconds, level_dps);
  out[2] = GD_ATTITUDE_RAD * GD_ATTITUDE_RAD * gd_turn_var(seconds, heading_dps);
}

/* Gives the bias its turn-on prior around the last estimate. The next window may be a rest from the start. */
static inline void gd_attitude_reopen(gd_attitude *a) {
  const gd_real bias_var = a->c.bias_sigma * a->c.bias_sigma;
  int i, k;
  for (k = 0; k < 3; k++) {
    a->turn_on_bias[k] = a->bias_xyz_dps[k] * GD_ATTITUDE_RAD;
  }
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    memcpy(h->bias, a->turn_on_bias, sizeof h->bias);
    h->knows_bias = 0;
    for (k = 0; k < 3; k++) {
      gd_reset_state(h->cov, GD_ATTITUDE_BIAS + k, bias_var);
    }
  }
  a->windows.total = 0;
  a->remembers = 0;
}

/* Goes over a gap to a sample that comes `step_s` later with these rates; returns whether the bias was reopened. */
static inline int gd_attitude_pass_gap(gd_attitude *a, double step_s, const gd_real gyro[3]) {
  const gd_real seconds = gd_gap_length_s(step_s);
  const gd_real turn_on_var = a->c.bias_sigma * a->c.bias_sigma;
  const gd_real drift_var = gd_drift_var(seconds, a->c.walk_var, a->c.drift_rate, turn_on_var);
  const int may_have_restarted = gd_may_have_restarted(a->longest_step_s, step_s);
  gd_real turn_var[3];
  int i, k;
  gd_attitude_turn_variances(turn_var, a, seconds, gyro);
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    h->regime = GD_ATTITUDE_UNDECIDED;
    gd_add_variance(h->cov, GD_ATTITUDE_BIAS, drift_var);
    for (k = 0; k < 3; k++) {
      h->cov[gd_place(GD_ATTITUDE_ATTITUDE + k, GD_ATTITUDE_ATTITUDE + k)] += turn_var[k];
    }
  }
  gd_attitude_forget_velocity(a);
  a->lived_s += step_s;
  a->windows.blocks = 0;
  memset(&a->segment, 0, sizeof a->segment);
  memcpy(a->gyro_dps, gyro, sizeof a->gyro_dps);
  a->suspect_s = 0;
  a->has_restarted = (uint8_t)(a->has_restarted || may_have_restarted);
  a->longest_step_s = gd_longest_after_gap_s(a->longest_step_s, step_s);
  if (may_have_restarted && a->c.bias_sigma > 0) {
    gd_attitude_reopen(a);
    return 1;
  }
  return 0;
}

#endif
