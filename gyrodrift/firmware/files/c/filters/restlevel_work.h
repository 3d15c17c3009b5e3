/* Restlevel: the work of a block that has ended, in portions. Twin of `_end_block` in restlevel/step.py.

   A portion is one update of one hypothesis, or what all of them share. The stages from GD_RL_FIRST_LOOP on have a
   portion for each hypothesis that they concern. Samples may come between two portions: the yaw after them follows from
   the last estimates, and the work reads nothing that they change.
*/
#ifndef GD_RESTLEVEL_WORK_H
#define GD_RESTLEVEL_WORK_H

#include "restlevel_block.h"

enum {
  GD_RL_BEGIN = GD_RL_FINISH + 1,
  GD_RL_NOISE,
  GD_RL_SEGMENT,
  GD_RL_LEAVE,
  GD_RL_ENTER,
  GD_RL_PREDICT,
  GD_RL_CONFIRM,
  GD_RL_COLLAPSE,
  GD_RL_UPDATE_BRANCH, /* a segment branches hypotheses */
  GD_RL_END_BRANCH,
  GD_RL_BEGIN_MERGE,
  GD_RL_MERGE,
  GD_RL_FIRST_LOOP,
  GD_RL_GRADUAL = GD_RL_FIRST_LOOP,
  GD_RL_COMPARE_STILL,
  GD_RL_UPDATE_STILL,
  GD_RL_WEIGH,
  GD_RL_UPDATE,
  GD_RL_RESUME,
  GD_RL_WEIGH_RESUMED,
  GD_RL_TURNS,
  GD_RL_BRANCH
};

static inline void gd_rl_go_to(gd_rl_work *w, uint8_t stage) {
  w->stage = stage;
  w->index = 0;
}

/* Mean rate of the block. */
static inline gd_real gd_rl_mean_dps(const gd_restlevel *s) { return s->block.angle_deg / (gd_real)s->block.seconds; }

/* Branches the hypotheses by a level; the stage `after` follows the merge. */
static inline void gd_rl_begin_branches(gd_restlevel *s, gd_rl_work *w, gd_rl_level level, uint8_t after) {
  w->level = level;
  w->after = after;
  w->rests.count = 0;
  gd_rl_close_gaps(s);
  gd_rl_go_to(w, GD_RL_BRANCH);
}

/* Follows the noise by the block. */
static inline void gd_rl_follow_noise_of_block(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  gd_rl_detect_freeze(s);
  w->is_stationary = !s->noise.is_frozen && gd_rl_is_stationary(s, seconds) && !gd_rl_has_moved(s);
  gd_rl_go_to(w, GD_RL_SEGMENT);
}

/* Follows the segments by the block. */
static inline void gd_rl_follow_segment(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  const gd_real mean_dps = gd_rl_mean_dps(s);
  w->step_dps = mean_dps - s->segment.last_mean_dps;
  gd_rl_track_segment(s, w->is_stationary, mean_dps, w->step_dps, seconds);
  gd_rl_weigh_noisy_rests(s);
  if (s->ended.short_start_blocks > 0) {
    gd_rl_begin_branches(s, w, gd_rl_short_level(s, seconds), GD_RL_LEAVE);
  } else {
    gd_rl_go_to(w, GD_RL_LEAVE);
  }
}

/* Processes the end of the last segment, if it ended with this block or with the block before. */
static inline void gd_rl_leave(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  gd_rl_go_to(w, GD_RL_ENTER);
  if (s->ended.blocks_ago == 1) {
    gd_rl_leave_segment(s);
  }
  if (s->ended.blocks_ago == 2 && s->ended.ended_gradually) {
    s->ended.ended_gradually = gd_rl_goes_on_gradually(s, w->step_dps, seconds) != 0;
    if (s->ended.ended_gradually) {
      gd_rl_go_to(w, GD_RL_GRADUAL);
    }
  }
}

/* Begins a segment, and processes temperature and the external rest sensor. */
static inline void gd_rl_enter(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  if (s->segment.blocks == 1) {
    gd_rl_enter_segment(s);
  }
  gd_rl_go_to(w, GD_RL_PREDICT);
#if GD_RESTLEVEL_AUXILIARY
  gd_rl_follow_temperature(s, w->temp_c, seconds);
  w->is_certain = gd_rl_is_certain_rest(s, gd_rl_mean_dps(s), seconds) != 0;
  if (w->is_certain) {
    gd_rl_begin_still(s, &w->still, gd_rl_mean_dps(s), seconds);
    w->best = GD_R(-1e30);
    w->excess_var = GD_R(0.0);
    gd_rl_go_to(w, GD_RL_COMPARE_STILL);
  } else if (s->witness.was_certain) {
    gd_rl_end_certain_rest(s);
  }
#else
  (void)seconds;
#endif
}

static inline void gd_rl_predict_block(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  gd_rl_predict(s, s->block.angle_deg, seconds, s->noise.angle_walk_var);
  gd_rl_widen_yaw(s, seconds);
  w->rest_weight = w->excess_var = GD_R(0.0);
  gd_rl_go_to(w, !w->is_certain && s->segment.blocks > gd_rl_confirming_blocks(s) ? GD_RL_WEIGH : GD_RL_CONFIRM);
}

/* Resumes the segment before, or branches the hypotheses, when a segment is confirmed. */
static inline void gd_rl_confirm(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  gd_rl_go_to(w, GD_RL_TURNS);
  if (s->segment.blocks > 1) {
    gd_rl_update_mean(s, gd_rl_mean_dps(s));
  }
  if (s->segment.blocks == gd_rl_confirming_blocks(s) && !w->is_certain) {
    if (gd_rl_continues(s, seconds)) {
      s->segment.seconds += s->ended.seconds;
      gd_rl_go_to(w, GD_RL_RESUME);
    } else {
      gd_rl_begin_branches(s, w, gd_rl_confirmed_level(s, seconds), GD_RL_TURNS);
      if (!gd_rl_is_loud(s) && !s->ended.ended_gradually) { /* after a gradual end it is the same turn */
        gd_rl_add_mean_rate(&s->turns, s->segment.mean_dps);
      }
    }
  } else if (gd_rl_is_loud(s) || s->segment.blocks < GD_CONFIRMED_BLOCKS) {
    gd_rl_follow_turns(&s->turns, s->block.angle_deg, s->block.seconds);
  }
}

/* Ends the block, once the output is computed. */
static inline void gd_rl_finish(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  const gd_real base_deg = s->base_deg;
  gd_rl_recover(s, w->expected_deg + s->base_deg);
  gd_rl_end_auxiliary(s, w->is_certain);
  s->travelled_deg += GD_ABS(s->block.angle_deg - s->bias_dps * seconds);
#if GD_RESTLEVEL_AIDS
  gd_rl_take_aid(s, w->expected_deg);
#endif
  gd_rl_keep_near_zero(s);
  gd_rl_count_correction(s, base_deg, w->expected_deg);
  memset(&s->block, 0, sizeof s->block);
  gd_rl_go_to(w, GD_RL_IDLE);
}

/* Merges a hypothesis with those that agree, or ends the merge. */
static inline void gd_rl_merge(gd_restlevel *s, gd_rl_work *w) {
  gd_rl_list list;
  gd_rl_list_all(s, &w->rests, &list);
  if (w->stage == GD_RL_BEGIN_MERGE) {
    gd_rl_normalise_list(&list);
    gd_rl_go_to(w, GD_RL_MERGE);
    w->later = 1;
  } else if (w->index < list.count) {
    w->later = gd_rl_merge_with_later(&list, w->index, w->later);
    if (w->later == list.count) {
      ++w->index;
      w->later = (uint8_t)(w->index + 1);
    }
  } else {
    gd_rl_prune_list(&list);
    gd_rl_store_rests(s, &w->rests);
    gd_rl_go_to(w, w->after);
  }
}

/* Whether the stage concerns a hypothesis. */
static inline int gd_rl_concerns(uint8_t stage, const gd_rl_hypothesis *h) {
  if (!(h->weight > GD_R(0.0))) {
    return 0;
  }
  switch (stage) {
    case GD_RL_BRANCH:
      return !h->is_at_rest;
    case GD_RL_GRADUAL:
    case GD_RL_RESUME:
    case GD_RL_WEIGH_RESUMED:
      return h->was_at_rest;
    case GD_RL_WEIGH:
    case GD_RL_UPDATE:
      return h->is_at_rest;
    default:
      return 1;
  }
}

/* The stage for one hypothesis. */
static inline void gd_rl_do_hypothesis(gd_restlevel *s, gd_rl_work *w, gd_rl_hypothesis *h, gd_real seconds) {
  const gd_real mean_dps = gd_rl_mean_dps(s);
  switch (w->stage) {
    case GD_RL_BRANCH:
      if (h->knows_bias || !gd_rl_is_loud(s)) {
        gd_rl_begin_branch(s, h, &w->rests.items[w->rests.count], &w->level);
        w->stage = GD_RL_UPDATE_BRANCH;
      }
      break;
    case GD_RL_GRADUAL:
      gd_rl_end_gradually(s, h);
      break;
#if GD_RESTLEVEL_AUXILIARY
    case GD_RL_COMPARE_STILL:
      gd_rl_compare_still(s, h, &w->still, seconds);
      w->best = gd_max(w->best, h->odds);
      break;
    case GD_RL_UPDATE_STILL:
      w->excess_var += gd_rl_update_still(s, h, &w->still, w->best);
      break;
#endif
    case GD_RL_WEIGH:
      gd_rl_weigh_block(s, w, h, mean_dps, seconds);
      break;
    case GD_RL_UPDATE:
      gd_rl_zero_velocity_update(s, h, mean_dps, seconds);
      break;
    case GD_RL_RESUME:
      gd_rl_resume(s, h, seconds);
      break;
    case GD_RL_WEIGH_RESUMED:
      gd_rl_weigh_segment(s, h);
      break;
    default:
      gd_rl_weigh_turns(&s->turns, h);
      break;
  }
}

#endif
