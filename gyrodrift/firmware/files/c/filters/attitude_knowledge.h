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

/* Number of the most probable hypothesis without a known bias; -1 without any. */
static inline int gd_attitude_unknown(gd_attitude *a) {
  int i;
  for (i = 0; i < a->sum.count; i++) {
    if (!gd_attitude_at(a, i)->knows_bias) {
      return i;
    }
  }
  return -1;
}

/* Drop the remembered biases once an unknown sensor is more probable by the biases that it shows in motion: by the
   density of its estimate at the remembered bias over that of its prior. The first rest candidate decides itself. */
static inline void gd_attitude_drop_wrong_memory(gd_attitude *a) {
  const gd_real error_var = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_MODEL_ERROR, weight = a->remembered.weight;
  const gd_real unit = GD_ATTITUDE_RAD * GD_ATTITUDE_RAD;
  gd_real spread[9], prior[9], off[3], log_odds;
  int i, k;
  i = a->remembers && a->segment.blocks == 0 ? gd_attitude_unknown(a) : -1;
  a->remembers = i >= 0;
  if (i < 0) {
    return;
  }
  memset(prior, 0, sizeof prior);
  gd_diagonal_block(spread, gd_attitude_at(a, i)->cov, GD_ATTITUDE_BIAS);
  for (k = 0; k < 9; k++) {
    spread[k] /= unit;
  }
  for (k = 0; k < 3; k++) {
    spread[4 * k] += a->remembered.bias_var[k];
    prior[4 * k] = a->c.bias_sigma * a->c.bias_sigma / unit + a->remembered.bias_var[k];
    off[k] = gd_attitude_at(a, i)->bias[k] / GD_ATTITUDE_RAD - a->remembered.bias_dps[k];
  }
  log_odds = gd_log_density(off, spread, error_var, 3) - gd_log_density(a->remembered.bias_dps, prior, error_var, 3);
  if (GD_LOG(weight) + log_odds < GD_LOG(GD_R(1.0) - weight)) {
    a->sum.order[0] = a->sum.order[i];
    a->sum.count = 1;
    gd_attitude_at(a, 0)->weight = 1;
    a->remembers = 0;
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
