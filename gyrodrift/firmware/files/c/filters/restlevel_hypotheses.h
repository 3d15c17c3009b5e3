/* Restlevel: hypotheses about which segments were rests, from block to block. Twin of restlevel/hypotheses.py. */
#ifndef GD_RESTLEVEL_HYPOTHESES_H
#define GD_RESTLEVEL_HYPOTHESES_H

#include "restlevel_branch.h"
#include "restlevel_collapse.h"
#include "restlevel_turns.h"

#define GD_LOUD_REST GD_R(0.1) /* share of rests with a running motor or fan */
#define GD_WELL_CALIBRATED GD_R(0.25)
#define GD_CALIBRATED_SO_SO GD_R(0.25) /* shares of parts that have subtracted their bias, well or partly */
#define GD_CALIBRATED GD_R(0.01)       /* of `turn_on_dps`, and its root: what is left then */

/* Adds a hypothesis that knows of no rest. */
static inline gd_rl_hypothesis *gd_rl_begin_one(gd_restlevel *s, gd_real yaw_deg, gd_real weight, gd_real bias_var) {
  gd_rl_hypothesis *h = &s->hypotheses[s->stored];
  memset(h, 0, sizeof *h);
  h->slot = (uint8_t)(s->stored++ & 15);
  h->weight = weight;
  h->yaw_deg = yaw_deg;
  h->bias_var = bias_var;
  h->odds = h->turn_density = GD_R(1.0);
  return h;
}

/* Adds the hypothesis of a remembered bias; returns the probability of all others. */
static inline gd_real gd_rl_begin_remembered(gd_restlevel *s, gd_real yaw_deg) {
#if GD_RESTLEVEL_MEMORY
  if (s->remembered.weight > GD_R(0.0)) {
    const gd_real bias_var = s->remembered.bias_var + s->c.rate_walk_var;
    gd_rl_hypothesis *h = gd_rl_begin_one(s, yaw_deg, s->remembered.weight, bias_var);
    h->bias_dps = s->remembered.bias_dps;
    h->knows_bias = 1;
    return GD_R(1.0) - s->remembered.weight;
  }
#endif
  (void)s, (void)yaw_deg;
  return GD_R(1.0);
}

/* What is remembered; else a part has subtracted its own bias well, or partly, or not at all. */
static inline void gd_rl_begin(gd_restlevel *s, gd_real yaw_deg) {
  const gd_real turn_on_var = s->c.turn_on_var;
  gd_real unknown;
  s->stored = 0;
  unknown = gd_rl_begin_remembered(s, yaw_deg);
  if (turn_on_var == GD_R(0.0)) { /* it has, and begins as one whose bias is known */
    gd_rl_begin_one(s, yaw_deg, unknown, GD_R(0.0))->knows_bias = 1;
  } else {
    const gd_real uncalibrated = unknown * (GD_R(1.0) - GD_WELL_CALIBRATED - GD_CALIBRATED_SO_SO);
    gd_rl_begin_one(s, yaw_deg, unknown * GD_WELL_CALIBRATED, turn_on_var * GD_CALIBRATED * GD_CALIBRATED);
    gd_rl_begin_one(s, yaw_deg, unknown * GD_CALIBRATED_SO_SO, turn_on_var * GD_CALIBRATED);
    gd_rl_begin_one(s, yaw_deg, uncalibrated, turn_on_var);
  }
  gd_rl_collapse(s);
}

/* What was said so far was no rate: all is as with the first block, but yaw stays. */
static inline void gd_rl_begin_anew(gd_restlevel *s) {
  gd_rl_begin(s, s->moments.yaw_deg);
  gd_rl_forget_noise(&s->noise);
  gd_rl_forget_levels(&s->wander);
  gd_rl_forget_turns(&s->turns);
  s->wander.was_stationary = 0;
  s->segment.blocks = s->blocks = 0;
  s->ended.blocks_ago = GD_NEVER;
  s->ended.short_start_blocks = 0;
  s->ended.ended_gradually = 0;
#if GD_RESTLEVEL_AUXILIARY
  s->sure_s = 0.0;
#endif
}

/* Keeps what each hypothesis says now, where a segment may begin. */
static inline void gd_rl_enter_segment(gd_restlevel *s) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    h->checkpoint.yaw_deg = h->yaw_deg;
    h->checkpoint.yaw_var = h->yaw_var;
    h->checkpoint.covariance = h->covariance;
    h->checkpoint.moving_s = h->moving_s;
  }
}

/* A confirmed segment has ended: no hypothesis is at rest any more. */
static inline void gd_rl_leave_segment(gd_restlevel *s) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].was_at_rest = s->hypotheses[k].is_at_rest;
    s->hypotheses[k].is_at_rest = 0;
  }
}

/* The last segment has ended as the flat part of a curve does. */
static inline void gd_rl_end_gradually(gd_restlevel *s) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    if (s->hypotheses[k].was_at_rest) {
      gd_rl_weigh_gradual_end(&s->hypotheses[k], (gd_real)s->ended.seconds, s->ended.sensor_odds);
      gd_rl_take_back(&s->hypotheses[k]);
    }
  }
  gd_rl_normalise(s);
}

/* Weighs all rests so far by the share of loud ones, where the noise has turned out smaller. */
static inline void gd_rl_doubt_loud_rests(gd_restlevel *s) {
  uint8_t k;
  if (!s->noise.has_dropped) {
    return;
  }
  for (k = 0; k < s->stored; ++k) {
    if (s->hypotheses[k].knows_bias) {
      s->hypotheses[k].weight *= GD_LOUD_REST;
    }
  }
  gd_rl_normalise(s);
}

/* A block passes: yaw turns where the device is not at rest, and the bias follows its random walk. */
static inline void gd_rl_predict(gd_restlevel *s, gd_real turned_deg, gd_real seconds) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    if (!h->is_at_rest) {
      h->yaw_deg += turned_deg - h->bias_dps * seconds;
      h->yaw_var += seconds * (h->bias_var * seconds - GD_R(2.0) * h->covariance + s->noise.angle_walk_var);
      h->covariance -= h->bias_var * seconds;
      h->moving_s += seconds;
    }
    h->bias_var += s->c.rate_walk_var * seconds;
  }
}

/* The segment that ended a moment ago continues: a block was out of line by chance, and that is no evidence. */
static inline void gd_rl_resume(gd_restlevel *s, gd_real seconds) {
  const gd_real mean_var = s->noise.angle_walk_var / (seconds * GD_R(GD_CONFIRMED_BLOCKS));
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    if (h->was_at_rest) {
      gd_rl_go_back(h, h);
      if (s->ended.ended_gradually) {
        gd_rl_give_back(h);
      }
      gd_rl_first_kalman_update(&s->c, h, s->segment.mean_dps, mean_var);
      h->is_at_rest = 1;
      gd_rl_weigh_rest(h, (gd_real)s->segment.seconds, s->segment.sensor_odds);
    }
  }
  gd_rl_normalise(s);
}

/* A confirmed segment goes on: hypotheses of rest take the block mean for the bias, and noise is learned. */
static inline void gd_rl_zero_velocity_update(gd_restlevel *s, gd_real mean_dps, gd_real step_dps, gd_real seconds) {
  const gd_real mean_var = s->noise.angle_walk_var / seconds, flicker_var = s->noise.flicker_var;
  const gd_real ramp_var = s->c.rate_ramp_dps_s * s->c.rate_ramp_dps_s * seconds * seconds;
  gd_real rest_weight = GD_R(0.0), excess_var = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    if (h->weight > GD_R(0.0) && h->is_at_rest) {
      const gd_real innovation_dps = mean_dps - h->bias_dps;
      const gd_real beyond_var = innovation_dps * innovation_dps - h->bias_var - mean_var - flicker_var;
      rest_weight += h->weight;
      h->chance_density *= GD_CHANCE_STAYS; /* a level by chance has ended by then, with its probability */
      gd_rl_weigh_rest(h, (gd_real)s->segment.seconds, s->segment.sensor_odds);
      excess_var += h->weight * gd_min(beyond_var, GD_FLICKER_CLIP * (mean_var + flicker_var));
      gd_rl_kalman_update(h, mean_dps, mean_var, ramp_var);
      h->moving_s = GD_R(0.0);
      gd_rl_follow_slide(&s->c, h, s->block.seconds);
    }
  }
  gd_rl_normalise(s);
  gd_rl_learn_at_rest(s, rest_weight, excess_var, step_dps, seconds);
}

#endif
