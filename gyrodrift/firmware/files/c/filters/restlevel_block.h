/* Restlevel: the end of a block. Twin of `_end_block` in restlevel/step.py. */
#ifndef GD_RESTLEVEL_BLOCK_H
#define GD_RESTLEVEL_BLOCK_H

#include "restlevel_frozen.h"
#include "restlevel_still.h"
#include "restlevel_temperature.h"

#define GD_RL_BASE_DEG GD_R(64.0) /* with floats, yaw of the hypotheses is kept below about this */

/* Resumes the segment before, or branches the hypotheses, when a segment is confirmed. */
static inline void gd_rl_confirm(gd_restlevel *s, gd_real seconds) {
  if (gd_rl_continues(s, seconds)) {
    s->segment.seconds += s->ended.seconds;
    gd_rl_resume(s, seconds);
  } else {
    gd_rl_branch(s, seconds);
    if (!gd_rl_is_loud(s) && !s->ended.ended_gradually) { /* after a gradual end it is the same turn */
      gd_rl_add_mean_rate(&s->turns, s->segment.mean_dps);
    }
  }
}

/* Processes the end of the last segment, if it ended with this block or with the block before. */
static inline void gd_rl_leave(gd_restlevel *s, gd_real step_dps, gd_real seconds) {
  if (s->ended.short_start_blocks > 0) {
    gd_rl_branch_at_end(s, seconds);
  }
  if (s->ended.blocks_ago == 1) {
    gd_rl_leave_segment(s);
  }
  if (s->ended.blocks_ago == 2 && s->ended.ended_gradually) {
    s->ended.ended_gradually = gd_rl_goes_on_gradually(s, step_dps, seconds) != 0;
    if (s->ended.ended_gradually) {
      gd_rl_end_gradually(s);
    }
  }
}

/* With floats, subtracts a whole multiple of 64 degrees from all yaws, so that a device that turns in one direction
   loses no digits. The multiples are exact. */
static inline void gd_rl_keep_near_zero(gd_restlevel *s) {
  const gd_real away_deg = GD_FLOOR(s->moments.yaw_deg / GD_RL_BASE_DEG) * GD_RL_BASE_DEG;
  uint8_t k;
  if (!GD_IS_FLOAT || GD_ABS(s->moments.yaw_deg) < GD_RL_BASE_DEG) {
    return;
  }
  s->base_deg += away_deg;
  s->moments.yaw_deg -= away_deg;
  s->start_yaw_deg -= away_deg;
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].yaw_deg -= away_deg;
    s->hypotheses[k].checkpoint.yaw_deg -= away_deg;
  }
}

/* Updates the hypotheses at a rest, branches them at a confirmed segment, and computes the output. */
static inline void gd_rl_take_rest(gd_restlevel *s, gd_real mean_dps, gd_real step_dps, gd_real seconds,
                                   int is_certain) {
  const int is_confirming = s->segment.blocks == gd_rl_confirming_blocks(s);
  if (!is_certain && gd_rl_is_confirmed(s) && !is_confirming) {
    gd_rl_zero_velocity_update(s, mean_dps, step_dps, seconds);
  }
  if (s->segment.blocks > 1) {
    gd_rl_update_mean(s, mean_dps);
  }
  if (!is_certain && is_confirming) {
    gd_rl_confirm(s, seconds);
  } else if (gd_rl_is_loud(s) || s->segment.blocks < GD_CONFIRMED_BLOCKS) {
    gd_rl_follow_turns(&s->turns, s->block.angle_deg, s->block.seconds);
  }
  gd_rl_weigh_turns(s);
  gd_rl_collapse(s);
}

/* Processes temperature and the external rest sensor; returns whether the block is a certain rest. */
static inline int gd_rl_take_auxiliary(gd_restlevel *s, gd_real mean_dps, gd_real step_dps, gd_real seconds) {
#if GD_RESTLEVEL_AUXILIARY
  int is_certain;
  gd_rl_follow_temperature(s, seconds);
  is_certain = gd_rl_is_certain_rest(s, mean_dps, seconds);
  if (is_certain) {
    gd_rl_stand_still(s, mean_dps, step_dps, seconds);
  } else if (s->witness.was_certain) {
    gd_rl_end_certain_rest(s);
  }
  return is_certain;
#else
  (void)s, (void)mean_dps, (void)step_dps, (void)seconds;
  return 0;
#endif
}

/* Learns the temperature of a sure rest at the end of the block. */
static inline void gd_rl_end_auxiliary(gd_restlevel *s, int is_certain) {
#if GD_RESTLEVEL_AUXILIARY
  s->lived_s += s->block.seconds;
  gd_rl_learn_when_sure(s, is_certain);
  s->witness.was_certain = is_certain != 0;
  s->witness.has_moved = s->witness.has_silence = 0;
#else
  (void)s, (void)is_certain;
#endif
}

/* 0 while all hypotheses are finite, else NaN. */
static inline gd_real gd_rl_probe(const gd_restlevel *s) {
  gd_real probe = s->moments.yaw_var - s->moments.yaw_var + (s->noise.angle_walk_var - s->noise.angle_walk_var);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    const gd_rl_hypothesis *h = &s->hypotheses[k];
    probe += (h->weight - h->weight) + (h->yaw_deg - h->yaw_deg) + (h->bias_dps - h->bias_dps);
    probe += (h->yaw_var - h->yaw_var) + (h->covariance - h->covariance) + (h->bias_var - h->bias_var);
  }
  return probe;
}

/* With floats, restarts from the last yaw if a damaged sample has exceeded their range, as a rate of 1e12 deg/s can.
   Doubles have this range. */
static inline void gd_rl_recover(gd_restlevel *s) {
  if (!GD_IS_FLOAT || gd_rl_probe(s) == GD_R(0.0)) {
    return;
  }
  s->moments.yaw_deg = s->yaw_deg;
  s->start_yaw_deg = s->yaw_deg;
  s->base_deg = s->travelled_deg = GD_R(0.0);
  s->segment.sensor_odds = GD_R(1.0);
  gd_rl_restart(s);
}

/* Passes a complete block to segments and hypotheses, and begins the next block. */
static inline void gd_rl_end_block(gd_restlevel *s) {
  const gd_real seconds = (gd_real)s->block.seconds, angle_deg = s->block.angle_deg;
  const gd_real mean_dps = angle_deg / seconds, step_dps = mean_dps - s->segment.last_mean_dps;
  int is_certain;
  s->travelled_s += seconds;
  if (gd_rl_begins_to_measure(&s->noise)) {
    gd_rl_restart(s);
  }
#if GD_RESTLEVEL_GAPS
  s->longest_step_s = gd_longest_step_s(s->block.seconds / (double)s->block.samples);
#endif
  gd_rl_detect_freeze(s);
  gd_rl_track_segment(s, mean_dps, step_dps, seconds);
  gd_rl_weigh_noisy_rests(s);
  gd_rl_leave(s, step_dps, seconds);
  if (s->segment.blocks == 1) {
    gd_rl_enter_segment(s);
  }
  is_certain = gd_rl_take_auxiliary(s, mean_dps, step_dps, seconds);
  gd_rl_predict(s, angle_deg, seconds, s->noise.angle_walk_var);
  gd_rl_widen_yaw(s, seconds);
  gd_rl_take_rest(s, mean_dps, step_dps, seconds, is_certain);
  gd_rl_recover(s);
  gd_rl_end_auxiliary(s, is_certain);
  s->travelled_deg += GD_ABS(angle_deg - s->bias_dps * seconds);
  gd_rl_keep_near_zero(s);
  memset(&s->block, 0, sizeof s->block);
}

#endif
