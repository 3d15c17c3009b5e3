/* Restlevel: hypotheses about which segments were rests, from block to block. Twin of restlevel/hypotheses.py. */
#ifndef GD_RESTLEVEL_HYPOTHESES_H
#define GD_RESTLEVEL_HYPOTHESES_H

#include "restlevel_branch.h"
#include "restlevel_collapse.h"
#include "restlevel_turns.h"

#define GD_NOISY_REST_SHARE GD_R(0.1)   /* share of rests with a running motor or fan */

/* Variance of the turn-on bias of a kind of parts. */
static inline gd_real gd_rl_part_var(const gd_restlevel *s, uint8_t kind) {
  return s->c.turn_on_var * gd_part_wider(kind) * gd_part_wider(kind);
}

/* Adds a hypothesis without a rest. */
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

/* Adds the hypotheses of an unknown part, with this probability of all together. A loop takes less flash than calls. */
static inline void gd_rl_begin_unknown(gd_restlevel *s, gd_real yaw_deg, gd_real weight) {
  const int is_known = s->c.turn_on_var == GD_R(0.0); /* it subtracts its bias: one hypothesis */
  const uint8_t kinds = is_known ? 1 : GD_PARTS;
  uint8_t k;
  for (k = 0; k < kinds; ++k) {
    const gd_real share = is_known ? GD_R(1.0) : gd_part_share(k);
    gd_rl_begin_one(s, yaw_deg, weight * share, gd_rl_part_var(s, k))->knows_bias = is_known != 0;
  }
}

/* Sets the initial hypotheses: the remembered bias, and the kinds of parts. */
static inline void gd_rl_begin(gd_restlevel *s, gd_real yaw_deg) {
  s->stored = 0;
  gd_rl_begin_unknown(s, yaw_deg, gd_rl_begin_remembered(s, yaw_deg));
  gd_rl_collapse(s);
}

/* Forgets the present and the last segment. */
static inline void gd_rl_forget_segments(gd_restlevel *s) {
  s->wander.was_stationary = 0;
  s->segment.blocks = 0;
#if GD_RESTLEVEL_VIBRATION
  s->vibration.blocks = 0;
#endif
  s->ended.blocks_ago = GD_NEVER;
  s->ended.short_start_blocks = 0;
  s->ended.ended_gradually = 0;
}

/* Restarts the filter with the present block, because the values so far were no rates. Yaw stays. */
static inline void gd_rl_restart(gd_restlevel *s) {
  gd_rl_begin(s, s->moments.yaw_deg);
  gd_rl_forget_noise(&s->noise);
  gd_rl_forget_levels(&s->wander);
  gd_rl_forget_turns(&s->turns);
  gd_rl_forget_segments(s);
#if GD_RESTLEVEL_VIBRATION
  s->vibration.motions = s->vibration.motion_var = GD_R(0.0);
#endif
  s->blocks = 0;
#if GD_RESTLEVEL_AUXILIARY
  s->sure_s = 0.0;
#endif
}

/* Gives the bias its turn-on prior around the last estimate. Yaw, its variance and the noise of the sensor stay. The
   next segment may be one from the start. */
static inline void gd_rl_reopen(gd_restlevel *s) {
  const gd_real bias_dps = s->bias_dps, yaw_var = s->moments.yaw_var;
  uint8_t k;
  s->stored = 0;
  gd_rl_begin_unknown(s, s->moments.yaw_deg, GD_R(1.0));
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].bias_dps = bias_dps;
    s->hypotheses[k].yaw_var = yaw_var;
  }
  gd_rl_collapse(s);
  gd_rl_forget_turns(&s->turns);
  s->blocks = 0;
}

/* Stores the yaw of each hypothesis where a segment may begin. */
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

/* Ends the rest of all hypotheses at the end of a confirmed segment. */
static inline void gd_rl_leave_segment(gd_restlevel *s) {
  uint8_t k;
#if GD_RESTLEVEL_VIBRATION
  if (s->ended.is_vibrating) {
    gd_rl_count_motion(s);
  }
#endif
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].was_at_rest = s->hypotheses[k].is_at_rest;
    s->hypotheses[k].is_at_rest = 0;
  }
}

/* Weighs a rest that has ended gradually, and restores its safe bias. */
static inline void gd_rl_end_gradually(const gd_restlevel *s, gd_rl_hypothesis *h) {
  gd_rl_weigh_gradual_end(h, (gd_real)s->ended.seconds, s->ended.sensor_odds);
  gd_rl_restore_safe_bias(h);
}

/* Weighs hypotheses with a rest by the share of noisy rests, if the noise has dropped. */
static inline void gd_rl_weigh_noisy_rests(gd_restlevel *s) {
  uint8_t k;
  if (!s->noise.has_dropped) {
    return;
  }
  for (k = 0; k < s->stored; ++k) {
    if (s->hypotheses[k].knows_bias) {
      s->hypotheses[k].weight *= GD_NOISY_REST_SHARE;
    }
  }
  gd_rl_normalise(s);
}

/* Predicts a block: yaw turns in hypotheses of motion, and the bias follows its random walk. */
static inline void gd_rl_predict(gd_restlevel *s, gd_real angle_deg, gd_real seconds, gd_real angle_walk_var) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    if (!h->is_at_rest) {
      h->yaw_deg += angle_deg - h->bias_dps * seconds;
      h->yaw_var += seconds * (h->bias_var * seconds - GD_R(2.0) * h->covariance + angle_walk_var);
      h->covariance -= h->bias_var * seconds;
      h->moving_s += seconds;
    }
    h->bias_var += s->c.rate_walk_var * seconds;
  }
}

/* Resumes a rest of the segment before: it goes on, and the blocks between are no evidence. */
static inline void gd_rl_resume(const gd_restlevel *s, gd_rl_hypothesis *h, gd_real seconds) {
  const gd_real mean_var = gd_rl_level_var(s, seconds);
  gd_rl_go_back(h, h);
  if (s->ended.ended_gradually) {
    gd_rl_undo_safe_bias(h);
  }
  gd_rl_measure_segment(s, h, s->segment.mean_dps, mean_var);
  h->is_at_rest = 1;
}

/* Variance of a further block mean of a rest. The shift of a bias by vibration stays for a while. */
static inline gd_real gd_rl_further_var(const gd_restlevel *s, gd_real seconds) {
  const gd_real block_var = gd_rl_block_mean_var(s, seconds);
  const gd_real shift_var = GD_VIBRATION_SHIFT_DPS * GD_VIBRATION_SHIFT_DPS * GD_VIBRATION_SHIFT_S / seconds;
  return gd_rl_is_vibrating(s) ? block_var + shift_var : block_var;
}

/* Weighs a hypothesis of rest by a further block of a confirmed segment, and sums up its excess of variance. */
static inline void gd_rl_weigh_block(const gd_restlevel *s, gd_rl_work *w, gd_rl_hypothesis *h, gd_real mean_dps,
                                     gd_real seconds) {
  const gd_real mean_var = gd_rl_further_var(s, seconds), flicker_var = s->noise.flicker_var;
  const gd_real innovation_dps = mean_dps - h->bias_dps;
  const gd_real beyond_var = innovation_dps * innovation_dps - h->bias_var - mean_var - flicker_var;
  w->rest_weight += h->weight;
  gd_rl_outlast_motions(h, s->segment.averages_out);
  gd_rl_weigh_segment(s, h);
  w->excess_var += h->weight * gd_min(beyond_var, GD_FLICKER_CLIP * (mean_var + flicker_var));
}

/* Updates it by the mean of the block. */
static inline void gd_rl_zero_velocity_update(const gd_restlevel *s, gd_rl_hypothesis *h, gd_real mean_dps,
                                              gd_real seconds) {
  const gd_real ramp_var = s->c.rate_ramp_dps_s * s->c.rate_ramp_dps_s * seconds * seconds;
  gd_rl_kalman_update(h, mean_dps, gd_rl_further_var(s, seconds), ramp_var);
  h->moving_s = gd_rl_is_vibrating(s) ? h->moving_s : GD_R(0.0);
  gd_rl_follow_slide(s->c.rate_ramp_dps_s, h, s->block.seconds);
}

#endif
