/* Restlevel: constant-rate segments: their beginning, length and end. Twin of restlevel/segments.py. */
#ifndef GD_RESTLEVEL_SEGMENTS_H
#define GD_RESTLEVEL_SEGMENTS_H

#include "restlevel_loud.h"
#include "restlevel_wander.h"

#define GD_CONFIRMED_BLOCKS 5          /* number of blocks that confirm a segment */
#define GD_SHORT_BLOCKS 3              /* smallest number of blocks of a short rest from the start */
#define GD_GATE_SIGMAS GD_R(4.0)       /* a block mean further from the segment's begins another segment */
#define GD_SLOPE_SIGMAS GD_R(2.0)      /* largest difference of the ends of a segment at its confirmation */
#define GD_GRADUAL_DPS_S GD_R(0.4)     /* largest change of the rate at a gradual end, deg/s^2 */
#define GD_MAX_GAP_BLOCKS 10           /* largest number of blocks between a segment and the segment that it resumes */
#define GD_START_SIGMAS GD_R(6.0)      /* range of the block means up to a rest from the start */
#define GD_LONG_SEGMENT_S 15.0         /* length from which on the gate is LONG_GATE_SIGMAS */
#define GD_LONG_GATE_SIGMAS GD_R(6.0)
#define GD_MEAN_BLOCKS 10              /* number of blocks in the mean of a segment */
#define GD_LESS_THAN_WHITE GD_R(0.4)   /* scatter of block means below that of white noise, over that of samples */

/* Number of blocks in the present mean of the segment. */
static inline gd_real gd_rl_mean_blocks(const gd_restlevel *s) {
  const uint32_t blocks = s->segment.blocks;
  return (gd_real)(gd_rl_is_loud(s) || blocks < GD_MEAN_BLOCKS ? blocks : GD_MEAN_BLOCKS);
}

/* Number of blocks that confirm the segment. */
static inline uint32_t gd_rl_confirming_blocks(const gd_restlevel *s) {
  return gd_rl_is_loud(s) ? GD_LOUD_BLOCKS : GD_CONFIRMED_BLOCKS;
}

/* Whether the segment is confirmed. */
static inline int gd_rl_is_confirmed(const gd_restlevel *s) {
  return s->segment.blocks >= gd_rl_confirming_blocks(s);
}

/* Variance of a block mean of the present segment. */
static inline gd_real gd_rl_block_mean_var(const gd_restlevel *s, gd_real seconds) {
#if GD_RESTLEVEL_LOUD
  if (s->segment.is_loud) {
    return s->loud.mean_var;
  }
#endif
  return s->noise.angle_walk_var / seconds;
}

/* Whether a block mean may belong to the segment. */
static inline int gd_rl_is_in_gate(const gd_restlevel *s, gd_real mean_dps, gd_real mean_var, gd_real ramp_dps) {
  const gd_real blocks_var = mean_var * (GD_R(1.0) + GD_R(1.0) / gd_rl_mean_blocks(s));
  const gd_real gate_var = blocks_var + ramp_dps * ramp_dps + s->noise.flicker_var;
  return GD_ABS(mean_dps - s->segment.mean_dps) < GD_GATE_SIGMAS * GD_SQRT(gate_var);
}

/* Whether a segment is from the start: in the first blocks, without motion before. */
static inline int gd_rl_is_from_start(const gd_restlevel *s, gd_real seconds) {
  const gd_real mean_var = s->noise.angle_walk_var / seconds;
  const gd_real range_dps = s->segment.most_dps - s->segment.least_dps;
  const int is_early = s->blocks < GD_MAX_GAP_BLOCKS + GD_CONFIRMED_BLOCKS && !gd_rl_is_loud(s);
  return is_early && range_dps < GD_START_SIGMAS * GD_SQRT(mean_var);
}

/* Updates the mean of the segment by a further block. */
static inline void gd_rl_update_mean(gd_restlevel *s, gd_real mean_dps) {
  s->segment.mean_dps += (mean_dps - s->segment.mean_dps) / gd_rl_mean_blocks(s);
}

/* Whether the block after the end of a segment also changes gradually. */
static inline int gd_rl_goes_on_gradually(const gd_restlevel *s, gd_real step_dps, gd_real seconds) {
  return s->wander.was_stationary && GD_ABS(step_dps) < GD_GRADUAL_DPS_S * seconds;
}

/* Whether a confirmed segment resumes the segment before. */
static inline int gd_rl_continues(const gd_restlevel *s, gd_real seconds) {
  const gd_rl_segment *segment = &s->segment;
  const gd_rl_ended *ended = &s->ended;
  const gd_real mean_var = gd_rl_block_mean_var(s, seconds);
  const gd_real ramp_dps = s->c.rate_ramp_dps_s * seconds * (gd_real)ended->blocks_ago;
  const gd_real blocks = GD_R(1.0) / GD_R(GD_CONFIRMED_BLOCKS) + GD_R(1.0) / GD_R(GD_MEAN_BLOCKS);
  const gd_real gate_var = mean_var * blocks + ramp_dps * ramp_dps + s->noise.flicker_var;
  const gd_real sigmas = ended->seconds >= GD_LONG_SEGMENT_S ? GD_LONG_GATE_SIGMAS : GD_GATE_SIGMAS;
#if GD_RESTLEVEL_LOUD
  if (!gd_rl_resumes(s)) {
    return 0;
  }
#endif
  return ended->blocks_ago <= GD_MAX_GAP_BLOCKS + GD_CONFIRMED_BLOCKS &&
         GD_ABS(segment->mean_dps - ended->mean_dps) < sigmas * GD_SQRT(gate_var);
}

/* Whether a present block in motion ends a short rest from the start. */
static inline int gd_rl_is_short_start(const gd_restlevel *s, gd_real seconds) {
  const uint32_t blocks = s->segment.blocks;
  return blocks >= GD_SHORT_BLOCKS && (gd_real)blocks * seconds >= GD_R(GD_CONFIRMED_BLOCKS) * (gd_real)s->c.window_s &&
         !gd_rl_is_loud(s) && blocks < GD_CONFIRMED_BLOCKS && gd_rl_is_from_start(s, seconds);
}

/* Updates the agreement of levels by a stationary block that follows a stationary block. */
static inline void gd_rl_follow_wander(gd_restlevel *s, gd_real mean_dps, gd_real seconds) {
  const gd_rl_segment *segment = &s->segment;
  const gd_real mean_var = s->noise.angle_walk_var / seconds, ramp_dps = s->c.rate_ramp_dps_s * seconds;
  if (segment->blocks > 0 && !gd_rl_is_in_gate(s, mean_dps, mean_var, ramp_dps)) {
    gd_rl_count_break(&s->wander, mean_dps - segment->mean_dps);
  } else if (segment->blocks < GD_CONFIRMED_BLOCKS) {
    gd_rl_count_agreement(&s->wander);
  }
}

/* Updates the likelihood of the scatter of the segment, as a variance of samples: of the samples, or as the steps
   between block means imply, if that is smaller. A vibration averages out within a block, a motion does not. */
static inline void gd_rl_follow_scatter(gd_restlevel *s) {
  gd_rl_segment *segment = &s->segment;
  const gd_real blocks = (gd_real)(segment->blocks - 1);
  const gd_real step_var = GD_R(0.25) * (gd_real)s->block.samples * segment->sum_squares / blocks;
  gd_real sample_var = s->noise.sample_var;
#if GD_RESTLEVEL_LOUD
  sample_var = segment->is_loud ? s->loud.sample_var : sample_var;
#endif
  segment->averages_out = step_var < GD_LESS_THAN_WHITE * sample_var;
  segment->sensor_odds =
      gd_rl_is_loud(s) ? GD_R(1.0) : gd_rl_sensor_odds(gd_max(GD_MIN_VAR, gd_min(sample_var, step_var)));
}

/* Extends the segment by a stationary or loud block, or begins another segment. */
static inline void gd_rl_take_block(gd_restlevel *s, gd_real mean_dps, gd_real seconds) {
  gd_rl_segment *segment = &s->segment;
  const gd_real ramp_dps = s->c.rate_ramp_dps_s * seconds;
  gd_real step_dps;
  int is_rest_like;
  if (segment->blocks == 0 || !gd_rl_is_in_gate(s, mean_dps, gd_rl_block_mean_var(s, seconds), ramp_dps)) {
    segment->blocks = 1;
    segment->seconds = s->block.seconds;
    segment->sum_squares = GD_R(0.0);
    segment->head_sum_dps = segment->mean_dps = mean_dps;
    gd_rl_may_rest(s);
    return;
  }
  step_dps = mean_dps - segment->last_mean_dps;
  segment->sum_squares += step_dps * step_dps;
  gd_count(&segment->blocks);
  segment->seconds += s->block.seconds;
  if (segment->blocks == 2) {
    segment->head_sum_dps += mean_dps;
  }
  gd_rl_follow_scatter(s);
  is_rest_like = gd_rl_may_rest(s);
  if (segment->blocks == gd_rl_confirming_blocks(s)) {
    const gd_real slope_dps = GD_R(0.5) * (segment->last_mean_dps + mean_dps - segment->head_sum_dps);
    const gd_real slope_var = gd_rl_block_mean_var(s, seconds) + GD_R(4.0) * ramp_dps * ramp_dps;
    is_rest_like = is_rest_like && GD_ABS(slope_dps) < GD_SLOPE_SIGMAS * GD_SQRT(slope_var);
  }
  if (!is_rest_like) {
    segment->blocks = 0;
  }
}

/* Updates the range of block means, the agreement of levels and the segment by the present block. */
static inline void gd_rl_take_mean(gd_restlevel *s, int is_stationary, int may_be_loud, gd_real mean_dps,
                                   gd_real seconds) {
  gd_rl_segment *segment = &s->segment;
  if (s->blocks < UINT8_MAX) {
    ++s->blocks;
  }
  if (s->blocks <= 2) { /* switching on may disturb the first block */
    segment->least_dps = segment->most_dps = mean_dps;
  }
  segment->least_dps = gd_min(segment->least_dps, mean_dps);
  segment->most_dps = gd_max(segment->most_dps, mean_dps);
  if (s->noise.has_dropped) {
    gd_rl_forget_levels(&s->wander);
  }
  if (is_stationary && s->wander.was_stationary) {
    gd_rl_follow_wander(s, mean_dps, seconds);
  }
  s->wander.was_stationary = is_stationary != 0;
  if (gd_rl_belongs_to_segment(s, is_stationary, may_be_loud)) {
    gd_rl_take_block(s, mean_dps, seconds);
  } else {
    segment->blocks = 0;
  }
  segment->last_mean_dps = mean_dps;
}

/* Whether an external rest sensor has reported motion in the block. */
static inline int gd_rl_has_moved(const gd_restlevel *s) {
#if GD_RESTLEVEL_AUXILIARY
  return s->witness.has_moved;
#else
  (void)s;
  return 0;
#endif
}

/* Takes a block into the present segment, begins another segment, or ends the segment. */
static inline void gd_rl_track_segment(gd_restlevel *s, int is_stationary, gd_real mean_dps, gd_real step_dps,
                                       gd_real seconds) {
  gd_rl_ended *ended = &s->ended;
  const gd_rl_segment before = s->segment;
  const int was_confirmed = gd_rl_is_confirmed(s);
#if GD_RESTLEVEL_LOUD
  const gd_real loud_before_var = s->loud.sample_var;
#endif
  const int may_be_loud = !is_stationary && !s->noise.is_frozen && !gd_rl_has_moved(s);
  const int is_short_start = !is_stationary && gd_rl_is_short_start(s, seconds);
  gd_rl_take_mean(s, is_stationary, may_be_loud, mean_dps, seconds);
  ended->short_start_blocks = is_short_start ? (uint8_t)before.blocks : 0;
  if (is_short_start || (was_confirmed && !gd_rl_is_confirmed(s))) {
    ended->mean_dps = before.mean_dps;
    ended->seconds = before.seconds;
    ended->sensor_odds = before.sensor_odds;
    ended->blocks_ago = 0;
    ended->ended_gradually = is_stationary && GD_ABS(step_dps) < GD_GRADUAL_DPS_S * seconds;
#if GD_RESTLEVEL_LOUD
    ended->is_loud = before.is_loud;
    ended->sample_var = loud_before_var;
    ended->ended_gradually = ended->ended_gradually && !before.is_loud;
#endif
  }
  if (ended->blocks_ago < GD_NEVER) {
    ++ended->blocks_ago;
  }
}

#endif
