/* Restlevel: the order of the portions; see restlevel_work.h. */
#ifndef GD_RESTLEVEL_PORTIONS_H
#define GD_RESTLEVEL_PORTIONS_H

#include "restlevel_work.h"

/* Ends a stage once all hypotheses are through. */
static inline void gd_rl_end_loop(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  switch (w->stage) {
    case GD_RL_BRANCH:
      gd_rl_go_to(w, GD_RL_BEGIN_MERGE);
      break;
    case GD_RL_GRADUAL:
      gd_rl_normalise(s);
      gd_rl_go_to(w, GD_RL_ENTER);
      break;
#if GD_RESTLEVEL_AUXILIARY
    case GD_RL_COMPARE_STILL:
      gd_rl_go_to(w, GD_RL_UPDATE_STILL);
      break;
    case GD_RL_UPDATE_STILL:
      gd_rl_learn_still(s, &w->still, w->excess_var, w->step_dps, seconds);
      w->rests.count = 0;
      w->after = GD_RL_PREDICT;
      gd_rl_go_to(w, GD_RL_BEGIN_MERGE);
      break;
#endif
    case GD_RL_WEIGH:
      gd_rl_go_to(w, GD_RL_UPDATE);
      break;
    case GD_RL_UPDATE:
      gd_rl_normalise(s);
      if (!gd_rl_is_loud(s)) {
        gd_rl_learn_at_rest(s, w->rest_weight, w->excess_var, w->step_dps, seconds);
      }
      gd_rl_go_to(w, GD_RL_CONFIRM);
      break;
    case GD_RL_RESUME:
      gd_rl_go_to(w, GD_RL_WEIGH_RESUMED);
      break;
    case GD_RL_WEIGH_RESUMED:
      gd_rl_normalise(s);
      gd_rl_go_to(w, GD_RL_TURNS);
      break;
    default:
      gd_rl_normalise(s);
      gd_rl_go_to(w, GD_RL_COLLAPSE);
      break;
  }
}

/* Does a portion of a stage that has one for each hypothesis. */
static inline void gd_rl_do_next_hypothesis(gd_restlevel *s, gd_rl_work *w, gd_real seconds) {
  if (w->stage == GD_RL_TURNS && s->turns.count < GD_LEAST_TURNS) {
    gd_rl_go_to(w, GD_RL_COLLAPSE);
    return;
  }
  while (w->index < s->stored && !gd_rl_concerns(w->stage, &s->hypotheses[w->index])) {
    ++w->index;
  }
  if (w->index < s->stored) {
    gd_rl_do_hypothesis(s, w, &s->hypotheses[w->index++], seconds);
  } else {
    gd_rl_end_loop(s, w, seconds);
  }
}

/* Does the next portion. */
static inline void gd_rl_do_portion(gd_restlevel *s, gd_rl_work *w) {
  const gd_real seconds = (gd_real)s->block.seconds;
  switch (w->stage) {
    case GD_RL_BEGIN:
      s->travelled_s += seconds;
      if (gd_rl_begins_to_measure(&s->noise)) {
        gd_rl_restart(s);
      }
      gd_rl_go_to(w, GD_RL_NOISE);
      break;
    case GD_RL_NOISE:
      gd_rl_follow_noise_of_block(s, w, seconds);
      break;
    case GD_RL_SEGMENT:
      gd_rl_follow_segment(s, w, seconds);
      break;
    case GD_RL_LEAVE:
      gd_rl_leave(s, w, seconds);
      break;
    case GD_RL_ENTER:
      gd_rl_enter(s, w, seconds);
      break;
    case GD_RL_PREDICT:
      gd_rl_predict_block(s, w, seconds);
      break;
    case GD_RL_CONFIRM:
      gd_rl_confirm(s, w, seconds);
      break;
    case GD_RL_COLLAPSE:
      gd_rl_collapse(s);
      gd_rl_go_to(w, GD_RL_FINISH);
      break;
    case GD_RL_FINISH:
      gd_rl_finish(s, w, seconds);
      break;
    case GD_RL_UPDATE_BRANCH:
      gd_rl_update_branch(s, &w->rests.items[w->rests.count], &w->level);
      w->stage = GD_RL_END_BRANCH;
      break;
    case GD_RL_END_BRANCH:
      gd_rl_end_branch(s, &w->rests);
      w->stage = GD_RL_BRANCH;
      break;
    case GD_RL_BEGIN_MERGE:
    case GD_RL_MERGE:
      gd_rl_merge(s, w);
      break;
    default:
      gd_rl_do_next_hypothesis(s, w, seconds);
      break;
  }
}

/* Begins the work of the block that ends with the last sample. */
static inline void gd_rl_begin_work(gd_restlevel *s, gd_rl_work *w) {
  w->expected_deg = gd_rl_expected_deg(s);
  w->is_certain = 0;
  gd_rl_go_to(w, GD_RL_BEGIN);
  s->noise.resolution_dps = s->resolution_dps;
#if GD_RESTLEVEL_GAPS
  s->longest_step_s = gd_longest_step_s(s->GD_RL_SUMS.seconds / (double)s->GD_RL_SUMS.samples);
#endif
#if GD_RESTLEVEL_AUXILIARY
  w->temp_c = s->temp_c;
  s->witness.has_moved = s->witness.is_moving;
  s->witness.has_silence = s->witness.is_silent;
  s->witness.is_moving = s->witness.is_silent = 0;
#endif
#if GD_RESTLEVEL_WORK
  s->block = s->sums;
  memset(&s->sums, 0, sizeof s->sums);
#endif
}

/* Does what is left of the work. Work on the stack is reached by an address: on AVR that saves 3 KB of flash. */
#if defined(__AVR__) && !GD_RESTLEVEL_WORK
__attribute__((noinline, unused)) static void gd_rl_do_all(gd_restlevel *s, gd_rl_work *w);
static void
#else
static inline void
#endif
gd_rl_do_all(gd_restlevel *s, gd_rl_work *w) {
  while (w->stage != GD_RL_IDLE) {
    gd_rl_do_portion(s, w);
  }
}

/* Does what is left of the last block, if gd_restlevel_work has not done it. */
static inline void gd_rl_catch_up(gd_restlevel *s) {
#if GD_RESTLEVEL_WORK
  gd_rl_do_all(s, &s->work);
#else
  (void)s;
#endif
}

/* Ends a block. Its work waits for gd_restlevel_work if that was called since the block before. */
static inline void gd_rl_end_block(gd_restlevel *s) {
#if GD_RESTLEVEL_WORK
  const int is_divided = s->work.is_divided;
  gd_rl_catch_up(s);
  gd_rl_begin_work(s, &s->work);
  s->work.is_divided = 0;
  if (!is_divided) {
    gd_rl_catch_up(s);
  }
#else
  gd_rl_work w;
  gd_rl_begin_work(s, &w);
  gd_rl_do_all(s, &w);
#endif
}

#endif
