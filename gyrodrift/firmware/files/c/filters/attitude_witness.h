/* Attitude filter: a rest sensor beside gyro and accelerometer: wheels, a charger, a disarmed state. */
#ifndef GD_ATTITUDE_WITNESS_H
#define GD_ATTITUDE_WITNESS_H

#include "attitude_evidence.h"

/* Window of a rest by a witness: as short as three blocks, with up to 15 deg/s of scatter. */
static inline gd_attitude_kind gd_attitude_still(void) {
  static const gd_attitude_kind still = {3, GD_R(100.0), GD_R(100.0), GD_R(2.0)};
  return still;
}

/* Whether the rates may be the bias of any hypothesis, or a first bias. */
static inline int gd_attitude_fits_bias(gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_real jump = GD_ATTITUDE_JUMP * a->c.bias_sigma, error = GD_R(0.1) * GD_ATTITUDE_RAD;
  const gd_real jump_var = jump * jump + error * error;
  const int may_be_first = gd_largest(m->gyro) < GD_MOST_FIRST * a->c.bias_sigma;
  int i, k;
  for (i = 0; i < a->sum.count; i++) {
    const gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    int is_near = 1;
    for (k = 0; k < 3; k++) {
      const gd_real var = h->cov[gd_place(GD_ATTITUDE_BIAS + k, GD_ATTITUDE_BIAS + k)] + jump_var + m->gyro_var[k];
      is_near = is_near && GD_ABS(m->gyro[k] - h->bias[k]) < GD_FIT_SIGMAS * GD_SQRT(gd_max(var, 0));
    }
    if (is_near || (may_be_first && !h->knows_bias)) {
      return 1;
    }
  }
  return 0;
}

/* Candidate of a witness that is believed; 0 without one. */
static inline int gd_attitude_certain_rest(gd_attitude_candidate *out, gd_attitude *a) {
  gd_attitude_witness *w = &a->witness;
  const gd_attitude_block *block = &a->block;
  if (block->still == 0 || block->moving > 0 || block->still < block->samples) {
    w->blocks = 0;
    w->is_believed = 1;
    return 0;
  }
  gd_count(&w->blocks);
  if (!w->is_believed || w->blocks < (uint32_t)gd_attitude_still().blocks) {
    return 0;
  }
  if (gd_attitude_last_window(out, &a->windows, gd_attitude_still(), a->c.limits) && gd_attitude_fits_bias(a, out)) {
    gd_count_fit(&w->contradictions);
    return 1;
  }
  if (gd_count_contradiction(&w->contradictions)) {
    w->is_believed = 0;
    gd_count(&w->refuted);
  }
  return 0;
}

/* Remove all hypotheses but those of rest, where there is any. */
static inline void gd_attitude_keep_rests(gd_attitude_sum *sum) {
  int i, rests = 0;
  for (i = 0; i < sum->count; i++) {
    rests += sum->slot[sum->order[i]].regime == GD_ATTITUDE_REST;
  }
  if (rests == 0) {
    return;
  }
  for (i = sum->count - 1; i >= 0; i--) {
    if (sum->slot[sum->order[i]].regime != GD_ATTITUDE_REST) {
      gd_attitude_remove(sum, i);
    }
  }
  gd_attitude_normalize(sum);
}

#endif
