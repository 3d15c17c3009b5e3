/* Attitude filter: memory and temperature on three axes. Twin of attitude/knowledge.py. */
#ifndef GD_ATTITUDE_KNOWLEDGE_H
#define GD_ATTITUDE_KNOWLEDGE_H

#include "attitude_mixture.h"
#include "attitude_witness.h"
#include "bias_memory.h"

/* Smallest density of a bias, 1/(deg/s)^3. */
#define GD_ATTITUDE_LEAST_DENSITY GD_R(1e-30)

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

/* Odds of a wider hypothesis that contains the remembered bias: prior odds, times the density of its prior there over
   that of its estimate. The covariances are in (deg/s)^2. */
static inline gd_real gd_attitude_odds(gd_real prior_odds, const gd_real prior_off[3], const gd_real prior[9],
                                       const gd_real off[3], const gd_real spread[9]) {
  const gd_real prior_density = GD_EXP(gd_log_density(prior_off, prior, GD_R(0.0), 3));
  return prior_odds * prior_density / (GD_EXP(gd_log_density(off, spread, GD_R(0.0), 3)) + GD_ATTITUDE_LEAST_DENSITY);
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

/* Odds of an unknown sensor against the memory by the biases that it shows in motion. */
static inline gd_real gd_attitude_odds_of_unknown(const gd_attitude *a, const gd_attitude_hypothesis *h) {
  const gd_real weight = a->remembered.weight, share = GD_R(1.0) - GD_ATTITUDE_JUMP_SHARE;
  gd_real prior[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, spread[9], off[3];
  int k;
  gd_attitude_off_memory(off, spread, a, h);
  for (k = 0; k < 3; k++) {
    const gd_real error_var = a->remembered.bias_var[k] + GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_MODEL_ERROR;
    const gd_real sigma_dps = a->c.bias_sigma / GD_ATTITUDE_RAD;
    prior[4 * k] = error_var + sigma_dps * sigma_dps;
    spread[4 * k] += error_var;
  }
  return gd_attitude_odds((GD_R(1.0) - weight) / weight / share, a->remembered.bias_dps, prior, off, spread);
}

/* Odds of a jump about the vertical against the memory. */
static inline gd_real gd_attitude_odds_of_jump(const gd_attitude *a, const gd_attitude_hypothesis *h) {
  const gd_real share = GD_ATTITUDE_JUMP_SHARE, sigma_dps = a->c.bias_sigma / GD_ATTITUDE_RAD;
  const gd_real zero[3] = {0, 0, 0}, *var = a->remembered.bias_var;
  const gd_real model_var = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_MODEL_ERROR;
  gd_real prior[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, spread[9], off[3];
  gd_attitude_off_memory(off, spread, a, h);
  prior[0] = prior[4] = (var[0] + var[1] + var[2]) / GD_R(3.0) + model_var;
  prior[8] = prior[0] + sigma_dps * sigma_dps;
  spread[0] += model_var;
  spread[4] += model_var;
  spread[8] += model_var;
  return gd_attitude_odds(share / (GD_R(1.0) - share), zero, prior, off, spread);
}

/* Trace of the covariance of the bias; 0 for a hypothesis without a known one. */
static inline gd_real gd_attitude_known_spread(const gd_attitude_hypothesis *h) {
  gd_real spread[9];
  gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
  return h->knows_bias ? spread[0] + spread[4] + spread[8] : GD_R(0.0);
}

/* Probabilities of the memory, of a jump about the vertical and of an unknown sensor by the biases in motion. The other
   two contain the remembered bias. The first rest candidate ends the comparison, and decides itself. */
static inline void gd_attitude_weigh_memory(gd_attitude *a) {
  int i, jumped = 0;
  a->remembers = a->remembers && a->segment.blocks == 0;
  if (!a->remembers) {
    return;
  }
  for (i = 1; i < a->sum.count; i++) {
    const int is_wider =
        gd_attitude_known_spread(gd_attitude_at(a, i)) > gd_attitude_known_spread(gd_attitude_at(a, jumped));
    jumped = is_wider ? i : jumped;
  }
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    if (!h->knows_bias) {
      h->weight = gd_attitude_odds_of_unknown(a, h);
    } else if (i == jumped && a->sum.count > 2) {
      h->weight = gd_attitude_odds_of_jump(a, h);
    } else {
      h->weight = GD_R(1.0);
    }
  }
  gd_attitude_normalize(&a->sum);
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
