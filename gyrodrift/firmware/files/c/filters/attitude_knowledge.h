/* Attitude filter: memory and temperature on three axes. Twin of attitude/knowledge.py. */
#ifndef GD_ATTITUDE_KNOWLEDGE_H
#define GD_ATTITUDE_KNOWLEDGE_H

#include "attitude_mixture.h"
#include "attitude_witness.h"
#include "bias_memory.h"

/* Give hypothesis number i of the sum the remembered biases. */
static inline void gd_attitude_recall(gd_attitude *a, int i, gd_real weight) {
  gd_attitude_hypothesis *h = &a->sum.slot[i];
  int k;
  *h = a->sum.slot[0];
  a->sum.order[i] = (uint8_t)i;
  a->sum.count = (uint8_t)(i + 1);
  h->weight = weight;
  h->knows_bias = 1;
  for (k = 0; k < 3; k++) {
    const int place = gd_place(GD_ATTITUDE_BIAS + k, GD_ATTITUDE_BIAS + k);
    h->bias[k] = a->remembered.bias_dps[k] * GD_ATTITUDE_RAD;
    h->cov[place] = GD_ATTITUDE_RAD * GD_ATTITUDE_RAD * a->remembered.bias_var[k] + a->c.walk_var;
  }
}

/* Add hypotheses for the remembered biases to that of an unknown sensor, which keeps the other probability. A bias that
   has jumped about the vertical alone looks like an even turn of a known sensor, so there is one for such a jump. */
static inline void gd_attitude_begin_remembered(gd_attitude *a) {
  const gd_real weight = a->remembered.weight, bias_var = a->c.bias_sigma * a->c.bias_sigma;
  gd_real up[3];
  int i, j;
  if (!(weight > 0)) {
    return;
  }
  gd_up_in_sensor(up, a->sum.slot[0].q);
#if GD_ATTITUDE_HYPOTHESES > 2
  gd_attitude_recall(a, 1, GD_ATTITUDE_JUMP_SHARE * weight);
  for (i = 0; i < 3; i++) {
    for (j = i; j < 3; j++) {
      a->sum.slot[1].cov[gd_place(GD_ATTITUDE_BIAS + i, GD_ATTITUDE_BIAS + j)] += bias_var * up[i] * up[j];
    }
  }
#else
  (void)bias_var, (void)i, (void)j;
#endif
  gd_attitude_recall(a, a->sum.count, weight * (GD_R(1.0) - GD_ATTITUDE_JUMP_SHARE));
  a->sum.slot[0].weight = GD_R(1.0) - weight;
  a->remembers = 1;
  gd_attitude_bring_forward(&a->sum);
}

/* Bias of a hypothesis as distance from the remembered one, deg/s, and its covariance, (deg/s)^2. */
static inline void gd_attitude_off_memory(gd_real off[3], gd_real spread[9], const gd_attitude *a,
                                          const gd_attitude_hypothesis *h) {
  int k;
  gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
  for (k = 0; k < 9; k++) {
    spread[k] /= GD_ATTITUDE_RAD * GD_ATTITUDE_RAD;
  }
  for (k = 0; k < 3; k++) {
    off[k] = h->bias[k] / GD_ATTITUDE_RAD - a->remembered.bias_dps[k];
  }
}

/* Logarithm of the odds of an unknown sensor against the memory by the biases that it shows in motion: the density of
   its prior at the remembered bias over that of its estimate. */
static inline gd_real gd_attitude_log_odds_of_unknown(const gd_attitude *a, const gd_attitude_hypothesis *h) {
  const gd_real model_var = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_MODEL_ERROR, *bias = a->remembered.bias_dps;
  const gd_real sigma_dps = a->c.bias_sigma / GD_ATTITUDE_RAD, weight = a->remembered.weight;
  gd_real prior[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, spread[9], off[3];
  int k;
  gd_attitude_off_memory(off, spread, a, h);
  for (k = 0; k < 3; k++) {
    prior[4 * k] = a->remembered.bias_var[k] + sigma_dps * sigma_dps;
    spread[4 * k] += a->remembered.bias_var[k];
  }
  return GD_LOG((GD_R(1.0) - weight) / weight) + gd_log_density(bias, prior, model_var, 3) -
         gd_log_density(off, spread, model_var, 3);
}

/* Likewise of a jump about the vertical. */
static inline gd_real gd_attitude_log_odds_of_jump(const gd_attitude *a, const gd_attitude_hypothesis *h) {
  const gd_real model_var = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_MODEL_ERROR, share = GD_ATTITUDE_JUMP_SHARE;
  const gd_real sigma_dps = a->c.bias_sigma / GD_ATTITUDE_RAD, *var = a->remembered.bias_var;
  const gd_real zero[3] = {0, 0, 0};
  gd_real prior[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, spread[9], off[3];
  gd_attitude_off_memory(off, spread, a, h);
  prior[0] = prior[4] = (var[0] + var[1] + var[2]) / GD_R(3.0);
  prior[8] = prior[0] + sigma_dps * sigma_dps;
  return GD_LOG(share / (GD_R(1.0) - share)) + gd_log_density(zero, prior, model_var, 3) -
         gd_log_density(off, spread, model_var, 3);
}

/* Trace of the covariance of the bias; 0 for a hypothesis without a known one. */
static inline gd_real gd_attitude_known_spread(const gd_attitude_hypothesis *h) {
  gd_real spread[9];
  gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
  return h->knows_bias ? spread[0] + spread[4] + spread[8] : GD_R(0.0);
}

/* Drop the remembered biases once a jump about the vertical or an unknown sensor is more probable in motion. The first
   rest candidate ends the comparison, and decides itself. */
static inline void gd_attitude_drop_wrong_memory(gd_attitude *a) {
  const gd_real weight = a->remembered.weight, jump = GD_ATTITUDE_JUMP_SHARE * weight;
  uint8_t unknown = 0, jumped = 0;
  int i;
  a->remembers = a->remembers && a->segment.blocks == 0;
  if (!a->remembers) {
    return;
  }
  for (i = 0; i < a->sum.count; i++) {
    const gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    unknown = h->knows_bias ? unknown : a->sum.order[i];
    jumped = i == 0 || gd_attitude_known_spread(h) > gd_attitude_known_spread(&a->sum.slot[jumped]) ? a->sum.order[i]
                                                                                                   : jumped;
  }
  if (gd_attitude_log_odds_of_unknown(a, &a->sum.slot[unknown]) > 0) {
    a->sum.order[0] = unknown;
    a->sum.count = 1;
    a->sum.slot[unknown].weight = 1;
    a->remembers = 0;
  } else if (a->sum.count > 2 && gd_attitude_log_odds_of_jump(a, &a->sum.slot[jumped]) > 0) {
    a->sum.order[0] = unknown;
    a->sum.order[1] = jumped;
    a->sum.count = 2;
    a->sum.slot[unknown].weight = (GD_R(1.0) - weight) / (GD_R(1.0) - weight + jump);
    a->sum.slot[jumped].weight = jump / (GD_R(1.0) - weight + jump);
  }
}

/* Move the biases of hypotheses in motion along the lines of their axes. */
static inline void gd_attitude_follow_temperature(gd_attitude *a, gd_real seconds) {
  gd_real step_dps[3], more_var[3];
  int i, k;
  if (a->temp_c == GD_UNKNOWN_C) {
    return;
  }
  for (k = 0; k < 3; k++) {
    step_dps[k] = gd_follow_line(&a->line[k], a->temp_c, a->rest_probability, seconds, &more_var[k]);
    a->remembered.bias_dps[k] += a->remembers ? step_dps[k] : GD_R(0.0);
    a->remembered.bias_var[k] += a->remembers ? more_var[k] : GD_R(0.0);
  }
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    for (k = 0; k < 3 && h->knows_bias && (h->regime != GD_ATTITUDE_REST || a->segment.blocks == 0); k++) {
      h->bias[k] += step_dps[k] * GD_ATTITUDE_RAD;
      h->cov[gd_place(GD_ATTITUDE_BIAS + k, GD_ATTITUDE_BIAS + k)] += GD_ATTITUDE_RAD * GD_ATTITUDE_RAD * more_var[k];
    }
  }
}

/* Measure the lines every ten seconds of a sure rest. */
static inline void gd_attitude_learn_when_sure(gd_attitude *a, gd_real seconds) {
  const int is_certain = a->witness.is_believed && a->witness.blocks >= (uint32_t)gd_attitude_still().blocks;
  const gd_real walk_var = a->c.walk_var / (GD_ATTITUDE_RAD * GD_ATTITUDE_RAD);
  int k;
  if (!gd_note_sure_rest(&a->sure_s, a->rest_probability, (double)seconds, is_certain) || a->temp_c == GD_UNKNOWN_C ||
      !gd_ends_point(a->sure_s, (double)seconds)) {
    return;
  }
  for (k = 0; k < 3; k++) {
    const gd_real var = a->bias_sigma_xyz_dps[k] * a->bias_sigma_xyz_dps[k];
    gd_measure_level(&a->line[k], a->bias_xyz_dps[k], var, a->lived_s, walk_var);
  }
}

#endif
