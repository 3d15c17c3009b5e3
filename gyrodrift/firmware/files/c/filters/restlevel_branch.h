/* Restlevel: a confirmed segment branches each hypothesis into a spin and a rest. Twin of `branch` in
   restlevel/hypotheses.py. */
#ifndef GD_RESTLEVEL_BRANCH_H
#define GD_RESTLEVEL_BRANCH_H

#include "restlevel_durations.h"
#include "restlevel_mixture.h"
#include "restlevel_segments.h"
#include "restlevel_slide.h"

/* Sets yaw and its covariance of `to` to their values in `h` at the beginning of the segment. */
static inline void gd_rl_go_back(const gd_rl_hypothesis *h, gd_rl_hypothesis *to) {
  to->yaw_deg = h->checkpoint.yaw_deg;
  to->yaw_var = h->checkpoint.yaw_var;
  to->covariance = h->checkpoint.covariance;
  to->moving_s = h->checkpoint.moving_s;
}

/* Variance of the mean of a segment that is confirmed now, as a bias. */
static inline gd_real gd_rl_level_var(const gd_restlevel *s, gd_real seconds) {
  const gd_real mean_var = gd_rl_block_mean_var(s, seconds) / (gd_real)gd_rl_confirming_blocks(s);
  return gd_rl_is_loud(s) ? mean_var + GD_LOUD_SHIFT_DPS * GD_LOUD_SHIFT_DPS : mean_var;
}

/* Updates a hypothesis at the beginning of a rest; returns the logarithm of the likelihood of the mean. A loud rest is
   no reason for a ramp of the bias: a gentle bend has such a mean. */
static inline gd_real gd_rl_measure_segment(const gd_restlevel *s, gd_rl_hypothesis *h, gd_real mean_dps,
                                            gd_real mean_var) {
  if (gd_rl_is_loud(s)) {
    return gd_rl_kalman_update(h, mean_dps, mean_var, GD_R(0.0));
  }
  return gd_rl_first_kalman_update(&s->c, h, mean_dps, mean_var);
}

/* Weighs the present rest of a hypothesis. */
static inline void gd_rl_weigh_segment(const gd_restlevel *s, gd_rl_hypothesis *h) {
#if GD_RESTLEVEL_LOUD
  if (s->segment.is_loud) {
    gd_rl_weigh_loud_rest(h, (gd_real)s->segment.seconds, gd_rl_level_density(s, h));
    return;
  }
#endif
  gd_rl_weigh_rest(h, (gd_real)s->segment.seconds, s->segment.sensor_odds);
}

/* Begins `rest` as the rest of a hypothesis, at the beginning of the segment. */
static inline void gd_rl_begin_branch(const gd_restlevel *s, const gd_rl_hypothesis *h, gd_rl_hypothesis *rest,
                                      const gd_rl_level *level) {
  const gd_real level_var = gd_rl_is_loud(s) ? GD_LOUD_LEVEL_DPS * GD_LOUD_LEVEL_DPS : s->noise.sample_var;
  *rest = *h;
  gd_rl_go_back(h, rest);
  rest->is_at_rest = 1;
  rest->was_at_rest = 0;
  gd_rl_begin_rest(rest, &s->wander, level->odds, level_var, level->mean_dps - h->bias_dps);
}

/* Updates it by the mean of the segment. */
static inline void gd_rl_update_branch(const gd_restlevel *s, gd_rl_hypothesis *rest, const gd_rl_level *level) {
  const gd_real log_likelihood = gd_rl_measure_segment(s, rest, level->mean_dps, level->mean_var);
  rest->weight = gd_rl_is_loud(s) ? rest->weight : rest->weight * GD_EXP(log_likelihood);
}

/* First slot from `slot` on that no hypothesis has. */
static inline uint8_t gd_rl_free_slot(const gd_restlevel *s, uint8_t slot) {
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    if (s->hypotheses[k].slot == slot) {
      ++slot;
    }
  }
  return slot;
}

/* Weighs a rest that has begun, and gives it a free slot if it is probable. */
static inline void gd_rl_end_branch(const gd_restlevel *s, gd_rl_rests *rests) {
  gd_rl_hypothesis *rest = &rests->items[rests->count];
  const uint8_t next = rests->count > 0 ? (uint8_t)(rests->items[rests->count - 1].slot + 1) : 0;
  gd_rl_weigh_segment(s, rest);
  gd_rl_mark_safe(rest);
  rest->slot = (uint8_t)(gd_rl_free_slot(s, next) & 15);
  rests->count = (uint8_t)(rests->count + (rest->weight > GD_R(0.0)));
}

/* Lists hypotheses and new rests in the order of their slots. */
static inline void gd_rl_list_all(gd_restlevel *s, gd_rl_rests *rests, gd_rl_list *list) {
  uint8_t k = 0, j = 0;
  list->count = 0;
  while (k < s->stored || j < rests->count) {
    const int is_old =
        j == rests->count || (k < s->stored && s->hypotheses[k].slot < rests->items[j].slot);
    list->items[list->count++] = is_old ? &s->hypotheses[k++] : &rests->items[j++];
  }
}

/* Stores a rest in the order of slots. */
static inline void gd_rl_store(gd_restlevel *s, const gd_rl_hypothesis *rest) {
  uint8_t k = s->stored++;
  for (; k > 0 && s->hypotheses[k - 1].slot > rest->slot; --k) {
    s->hypotheses[k] = s->hypotheses[k - 1];
  }
  s->hypotheses[k] = *rest;
}

/* Keeps the rests that are left after the merge. */
static inline void gd_rl_store_rests(gd_restlevel *s, gd_rl_rests *rests) {
  uint8_t j;
  gd_rl_close_gaps(s);
  for (j = 0; j < rests->count; ++j) {
    if (rests->items[j].weight > GD_R(0.0)) {
      gd_rl_store(s, &rests->items[j]);
    }
  }
  rests->count = 0;
}

/* Level of a confirmed segment, which branches each hypothesis into a spin, and a rest that begins where it began. */
static inline gd_rl_level gd_rl_confirmed_level(const gd_restlevel *s, gd_real seconds) {
  gd_rl_level level;
  level.mean_dps = s->segment.mean_dps;
  level.mean_var = gd_rl_level_var(s, seconds);
  level.odds = gd_rl_is_from_start(s, seconds) ? s->c.start_odds : s->c.rest_odds;
#if GD_RESTLEVEL_LOUD
  level.odds = s->segment.is_loud ? gd_rl_loud_odds(s, level.odds) : level.odds;
#endif
  return level;
}

/* Level of a short rest from the start, which branches each hypothesis at its end. */
static inline gd_rl_level gd_rl_short_level(const gd_restlevel *s, gd_real seconds) {
  gd_rl_level level;
  level.mean_dps = s->ended.mean_dps;
  level.mean_var = s->noise.angle_walk_var / (seconds * (gd_real)s->ended.short_start_blocks);
  level.odds = s->c.rest_odds;
  return level;
}

#endif
