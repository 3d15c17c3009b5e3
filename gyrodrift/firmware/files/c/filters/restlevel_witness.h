/* Restlevel: an external rest sensor, as wheels and chargers have. Twin of restlevel/witness.py. */
#ifndef GD_RESTLEVEL_WITNESS_H
#define GD_RESTLEVEL_WITNESS_H

#include "restlevel_hypotheses.h"

#if GD_RESTLEVEL_AUXILIARY

#define GD_AGREEMENT_SIGMAS GD_R(4.0)    /* contradicting blocks within this of their mean have one level */
#define GD_MOST_JUMP GD_R(1.0)           /* largest jump of a known bias, in sigmas of the turn-on bias */
#define GD_FIRST_BLOCKS 2                /* contradicting blocks of one level that show a first bias */

/* Counts the report of a sample: 1 at rest, 0 in motion, NaN without a report. */
static inline void gd_rl_hear(gd_rl_witness *w, gd_real still) {
  if (!(still == GD_R(1.0))) {
    w->is_silent = 1;
    if (still >= GD_R(0.0)) {
      w->is_moving = 1;
    }
  }
}

/* Variance of a block mean, larger if the block has more noise than the sensor at rest: a motor that runs. */
static inline gd_real gd_rl_noisy_mean_var(const gd_restlevel *s, gd_real seconds) {
  const gd_real louder = s->noise.last_block_var / s->noise.sample_var;
  return s->noise.angle_walk_var / seconds * (s->noise.is_walk_measured ? gd_max(GD_R(1.0), louder) : louder);
}

/* Adds a variance to the bias of all hypotheses, (deg/s)^2. */
static inline void gd_rl_widen_bias(gd_restlevel *s, gd_real variance) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].bias_var += variance;
  }
}

/* Probability of the hypotheses that know a bias. */
static inline gd_real gd_rl_known_weight(const gd_restlevel *s) {
  gd_real weight = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    if (s->hypotheses[k].knows_bias) {
      weight += s->hypotheses[k].weight;
    }
  }
  return weight;
}

/* Follows the level of contradicting blocks: that of those before, or a new one. */
static inline void gd_rl_follow_level(gd_restlevel *s, gd_real mean_dps, gd_real mean_var, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  const gd_real ramp_dps = s->c.rate_ramp_dps_s * seconds;
  const gd_real spread_var = GD_R(2.0) * mean_var + ramp_dps * ramp_dps + s->noise.flicker_var;
  if (w->agreeing_blocks > 0 && GD_ABS(mean_dps - w->level_dps) < GD_AGREEMENT_SIGMAS * GD_SQRT(spread_var)) {
    if (w->agreeing_blocks < UINT8_MAX) {
      ++w->agreeing_blocks;
    }
    w->level_dps += (mean_dps - w->level_dps) / (gd_real)w->agreeing_blocks;
  } else {
    w->agreeing_blocks = 1;
    w->level_dps = mean_dps;
  }
}

/* Whether contradicting blocks up to the present one show a first bias, or a bias that has jumped. */
static inline int gd_rl_is_new_level(gd_restlevel *s, gd_real mean_dps, gd_real mean_var, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  const int is_known = gd_rl_known_weight(s) > GD_MAJORITY;
  const gd_real most = is_known ? GD_MOST_JUMP : GD_MOST_FIRST;
  gd_real away_dps, learned_dps;
  gd_rl_follow_level(s, mean_dps, mean_var, seconds);
  away_dps = is_known ? w->level_dps - s->bias_dps : w->level_dps;
  if (w->agreeing_blocks >= (is_known ? GD_CONFIRMED_BLOCKS : GD_FIRST_BLOCKS) &&
      away_dps * away_dps < most * most * s->c.turn_on_var) {
    if (is_known) { /* the first update widens an unknown bias itself */
      gd_rl_widen_bias(s, away_dps * away_dps);
    }
    w->contradictions = GD_R(0.0);
    w->agreeing_blocks = 0;
    return 1;
  }
  if (!gd_count_contradiction(&w->contradictions)) {
    return 0;
  }
  learned_dps = s->bias_dps - w->before_dps;
  gd_rl_widen_bias(s, learned_dps * learned_dps);
  w->is_believed = 0;
  if (w->refuted < UINT16_MAX) {
    ++w->refuted;
  }
  w->agreeing_blocks = 0;
  return 0;
}

/* Whether the sensor reports rest for all samples of the present block. */
static inline int gd_rl_reports_rest(gd_restlevel *s, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  w->since_s = s->rest_probability > GD_MAJORITY ? seconds : w->since_s + seconds;
  if (w->has_moved || w->has_silence) {
    w->is_believed = 1;
    w->is_reporting_rest = 0;
    w->agreeing_blocks = 0;
    return 0;
  }
  if (!w->is_reporting_rest) {
    w->is_reporting_rest = 1;
    w->before_dps = s->bias_dps;
  }
  return 1;
}

/* Whether the present block is a certain rest; contradictions are counted. */
static inline int gd_rl_is_certain_rest(gd_restlevel *s, gd_real mean_dps, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  gd_real mean_var, ramp_dps, fit_var;
  if (!gd_rl_reports_rest(s, seconds) || !w->is_believed) {
    return 0;
  }
  mean_var = gd_rl_noisy_mean_var(s, seconds);
  ramp_dps = s->c.rate_ramp_dps_s * gd_min(w->since_s, GD_MAX_RAMP_S);
  fit_var = s->moments.bias_var + mean_var + s->noise.flicker_var + ramp_dps * ramp_dps;
  if (GD_ABS(mean_dps - s->bias_dps) < GD_FIT_SIGMAS * GD_SQRT(fit_var)) {
    gd_count_fit(&w->contradictions);
    w->agreeing_blocks = 0;
    return 1;
  }
  return gd_rl_is_new_level(s, mean_dps, mean_var, seconds);
}

/* Ends certain rests: without a confirmed segment no hypothesis stays at rest. */
static inline void gd_rl_end_certain_rest(gd_restlevel *s) {
  uint8_t k;
  for (k = 0; !gd_rl_is_confirmed(s) && k < s->stored; ++k) {
    s->hypotheses[k].is_at_rest = 0;
  }
}

#endif

#endif
