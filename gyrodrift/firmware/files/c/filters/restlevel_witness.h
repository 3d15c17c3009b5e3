/* Restlevel: an external rest sensor, as wheels and chargers have. Twin of restlevel/witness.py. */
#ifndef GD_RESTLEVEL_WITNESS_H
#define GD_RESTLEVEL_WITNESS_H

#include "restlevel_hypotheses.h"

#if GD_RESTLEVEL_AUXILIARY

#define GD_FIT_SIGMAS GD_R(6.0)       /* a block mean further from the bias contradicts the sensor */
#define GD_AGREEMENT_SIGMAS GD_R(4.0) /* contradicting blocks within this of each other have one level */
#define GD_MOST_DOUBT GD_R(5.0)       /* contradicting blocks after which the sensor is not believed */
#define GD_FORGIVEN GD_R(0.1)         /* doubt that each block takes away which fits */
#define GD_MOST_FIRST GD_R(20.0)      /* how far out a first bias may be, in sigmas of the turn-on bias */
#define GD_MOST_JUMP GD_R(1.0)        /* how far a known one jumps */
#define GD_FIRST_BLOCKS 2             /* contradicting blocks of one level that show a first bias */
#define GD_KNOWN GD_R(0.5)            /* probability from which on hypotheses that know a bias stand for all */

/* Takes what the sensor says of one sample: 1 at rest, 0 in motion, NaN nothing. */
static inline void gd_rl_hear(gd_rl_witness *w, gd_real still) {
  if (!(still == GD_R(1.0))) {
    w->has_silence = 1;
    if (still >= GD_R(0.0)) {
      w->has_moved = 1;
    }
  }
}

/* Variance of a block mean, larger where the block is louder than the sensor: a motor that runs. */
static inline gd_real gd_rl_loud_mean_var(const gd_restlevel *s, gd_real seconds) {
  const gd_real louder = s->noise.last_block_var / s->noise.sample_var;
  return s->noise.angle_walk_var / seconds * (s->noise.is_walk_measured ? gd_max(GD_R(1.0), louder) : louder);
}

/* Makes the bias of all hypotheses less certain, (deg/s)^2. */
static inline void gd_rl_open(gd_restlevel *s, gd_real variance) {
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

/* Counts a contradicting block: it has the level of those before, or another one. */
static inline void gd_rl_count_contradiction(gd_restlevel *s, gd_real mean_dps, gd_real mean_var, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  const gd_real ramp_dps = s->c.rate_ramp_dps_s * seconds;
  const gd_real spread_var = GD_R(2.0) * mean_var + ramp_dps * ramp_dps + s->noise.flicker_var;
  if (w->alike > 0 && GD_ABS(mean_dps - w->level_dps) < GD_AGREEMENT_SIGMAS * GD_SQRT(spread_var)) {
    if (w->alike < UINT8_MAX) {
      ++w->alike;
    }
    w->level_dps += (mean_dps - w->level_dps) / (gd_real)w->alike;
  } else {
    w->alike = 1;
    w->level_dps = mean_dps;
  }
  w->doubt += GD_R(1.0);
}

/* Whether a contradicting block is the last of those that show a bias that has jumped. */
static inline int gd_rl_is_new_level(gd_restlevel *s, gd_real mean_dps, gd_real mean_var, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  const int is_known = gd_rl_known_weight(s) > GD_KNOWN;
  const gd_real most = is_known ? GD_MOST_JUMP : GD_MOST_FIRST;
  gd_real away_dps, learned_dps;
  gd_rl_count_contradiction(s, mean_dps, mean_var, seconds);
  away_dps = is_known ? w->level_dps - s->bias_dps : w->level_dps;
  if (w->alike >= (is_known ? GD_CONFIRMED_BLOCKS : GD_FIRST_BLOCKS) &&
      away_dps * away_dps < most * most * s->c.turn_on_var) {
    if (is_known) { /* of a bias that no rest has shown yet the first update takes care */
      gd_rl_open(s, away_dps * away_dps);
    }
    w->doubt = GD_R(0.0);
    w->alike = 0;
    return 1;
  }
  if (w->doubt < GD_MOST_DOUBT) {
    return 0;
  }
  learned_dps = s->bias_dps - w->before_dps;
  gd_rl_open(s, learned_dps * learned_dps);
  w->is_believed = 0;
  if (w->refuted < UINT16_MAX) {
    ++w->refuted;
  }
  w->doubt = GD_MOST_DOUBT - GD_R(1.0);
  w->alike = 0;
  return 0;
}

/* Whether the sensor reports rest all through the block that has just ended. */
static inline int gd_rl_is_claim(gd_restlevel *s, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  w->since_s = s->rest_probability > GD_KNOWN ? seconds : w->since_s + seconds;
  if (w->has_moved || w->has_silence) {
    w->is_believed = 1;
    w->is_claiming = 0;
    w->alike = 0;
    return 0;
  }
  if (!w->is_claiming) {
    w->is_claiming = 1;
    w->before_dps = s->bias_dps;
  }
  return 1;
}

/* Whether the block that has just ended is a rest by a sensor that is believed. */
static inline int gd_rl_is_certain_rest(gd_restlevel *s, gd_real mean_dps, gd_real seconds) {
  gd_rl_witness *w = &s->witness;
  gd_real mean_var, ramp_dps, fit_var;
  if (!gd_rl_is_claim(s, seconds) || !w->is_believed) {
    return 0;
  }
  mean_var = gd_rl_loud_mean_var(s, seconds);
  ramp_dps = s->c.rate_ramp_dps_s * gd_min(w->since_s, GD_MAX_RAMP_S);
  fit_var = s->moments.bias_var + mean_var + s->noise.flicker_var + ramp_dps * ramp_dps;
  if (GD_ABS(mean_dps - s->bias_dps) < GD_FIT_SIGMAS * GD_SQRT(fit_var)) {
    w->doubt = gd_max(GD_R(0.0), w->doubt - GD_FORGIVEN);
    w->alike = 0;
    return 1;
  }
  return gd_rl_is_new_level(s, mean_dps, mean_var, seconds);
}

/* The sensor reports rest no longer: without a confirmed segment nothing else says so. */
static inline void gd_rl_end_certain_rest(gd_restlevel *s) {
  uint8_t k;
  for (k = 0; s->segment.blocks < GD_CONFIRMED_BLOCKS && k < s->stored; ++k) {
    s->hypotheses[k].is_at_rest = 0;
  }
}

#endif

#endif
