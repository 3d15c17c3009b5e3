/* Restlevel: constant-rate segments: their beginning, length and end. Twin of restlevel/segments.py. */
#ifndef GD_RESTLEVEL_SEGMENTS_H
#define GD_RESTLEVEL_SEGMENTS_H

#include "restlevel_noise.h"
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

/* Number of blocks in the present mean of the segment. */
static inline gd_real gd_rl_mean_blocks(const gd_rl_segment *segment) {
  return (gd_real)(segment->blocks < GD_MEAN_BLOCKS ? segment->blocks : GD_MEAN_BLOCKS);
}

/* Whether a block mean may belong to the segment. */
static inline int gd_rl_is_in_gate(const gd_rl_segment *segment, gd_real mean_dps, gd_real mean_var, gd_real ramp_dps,
                                   gd_real flicker_var) {
  const gd_real gate_var =
      mean_var * (GD_R(1.0) + GD_R(1.0) / gd_rl_mean_blocks(segment)) + ramp_dps * ramp_dps + flicker_var;
  return GD_ABS(mean_dps - segment->mean_dps) < GD_GATE_SIGMAS * GD_SQRT(gate_var);
}

/* Whether a segment is from the start: in the first blocks, without motion before. */
static inline int gd_rl_is_from_start(const gd_restlevel *s, gd_real seconds) {
  const gd_real mean_var = s->noise.angle_walk_var / seconds;
  const gd_real range_dps = s->segment.most_dps - s->segment.least_dps;
  return s->blocks < GD_MAX_GAP_BLOCKS + GD_CONFIRMED_BLOCKS && range_dps < GD_START_SIGMAS * GD_SQRT(mean_var);
}

/* Updates the mean of the segment by a further block. */
static inline void gd_rl_update_mean(gd_rl_segment *segment, gd_real mean_dps) {
  segment->mean_dps += (mean_dps - segment->mean_dps) / gd_rl_mean_blocks(segment);
}

/* Whether the block after the end of a segment also changes gradually. */
static inline int gd_rl_goes_on_gradually(const gd_restlevel *s, gd_real step_dps, gd_real seconds) {
  return s->wander.was_stationary && GD_ABS(step_dps) < GD_GRADUAL_DPS_S * seconds;
}

/* Whether a confirmed segment resumes the segment before. */
static inline int gd_rl_continues(const gd_restlevel *s, gd_real seconds) {
  const gd_rl_segment *segment = &s->segment;
  const gd_rl_ended *ended = &s->ended;
  const gd_real mean_var = s->noise.angle_walk_var / seconds;
  const gd_real ramp_dps = s->c.rate_ramp_dps_s * seconds * (gd_real)ended->blocks_ago;
  const gd_real blocks = GD_R(1.0) / GD_R(GD_CONFIRMED_BLOCKS) + GD_R(1.0) / GD_R(GD_MEAN_BLOCKS);
  const gd_real gate_var = mean_var * blocks + ramp_dps * ramp_dps + s->noise.flicker_var;
  const gd_real sigmas = ended->seconds >= GD_LONG_SEGMENT_S ? GD_LONG_GATE_SIGMAS : GD_GATE_SIGMAS;
  return ended->blocks_ago <= GD_MAX_GAP_BLOCKS + GD_CONFIRMED_BLOCKS &&
         GD_ABS(segment->mean_dps - ended->mean_dps) < sigmas * GD_SQRT(gate_var);
}

/* Whether a present block in motion ends a short rest from the start. */
static inline int gd_rl_is_short_start(const gd_restlevel *s, gd_real seconds) {
  const uint32_t blocks = s->segment.blocks;
  return blocks >= GD_SHORT_BLOCKS && (gd_real)blocks * seconds >= GD_R(GD_CONFIRMED_BLOCKS) * (gd_real)s->c.window_s &&
         blocks < GD_CONFIRMED_BLOCKS && gd_rl_is_from_start(s, seconds);
}

/* Updates the agreement of levels by a stationary block that follows a stationary block. */
static inline void gd_rl_follow_wander(gd_restlevel *s, gd_real mean_dps, gd_real seconds) {
  const gd_rl_segment *segment = &s->segment;
  const gd_real mean_var = s->noise.angle_walk_var / seconds, ramp_dps = s->c.rate_ramp_dps_s * seconds;
  if (segment->blocks > 0 && !gd_rl_is_in_gate(segment, mean_dps, mean_var, ramp_dps, s->noise.flicker_var)) {
    gd_rl_count_break(&s->wander, mean_dps - segment->mean_dps);
  } else if (segment->blocks < GD_CONFIRMED_BLOCKS) {
    gd_rl_count_agreement(&s->wander);
  }
}

/* Extends the segment by a stationary block, or begins another segment. */
static inline void gd_rl_take_block(gd_rl_segment *segment, const gd_rl_noise *noise, gd_real mean_dps,
                                    gd_real ramp_dps, double seconds) {
  const gd_real mean_var = noise->angle_walk_var / (gd_real)seconds;
  gd_real step_dps;
  if (segment->blocks == 0 || !gd_rl_is_in_gate(segment, mean_dps, mean_var, ramp_dps, noise->flicker_var)) {
    segment->blocks = 1;
    segment->seconds = seconds;
    segment->sum_squares = GD_R(0.0);
    segment->head_sum_dps = segment->mean_dps = mean_dps;
    return;
  }
  step_dps = mean_dps - segment->last_mean_dps;
  segment->sum_squares += step_dps * step_dps;
  gd_count(&segment->blocks);
  segment->seconds += seconds;
  if (segment->blocks == 2) {
    segment->head_sum_dps += mean_dps;
  }
  if (segment->blocks == GD_CONFIRMED_BLOCKS) {
    const gd_real slope_dps = GD_R(0.5) * (segment->last_mean_dps + mean_dps - segment->head_sum_dps);
    if (GD_ABS(slope_dps) >= GD_SLOPE_SIGMAS * GD_SQRT(mean_var + GD_R(4.0) * ramp_dps * ramp_dps)) {
      segment->blocks = 0;
    }
  }
}

/* Scatter of the segment as a variance of samples: the variance of the samples, or the variance that the steps between
   block means imply, if that is smaller. A vibration averages out within a block, a motion does not. */
static inline gd_real gd_rl_scatter_var(const gd_restlevel *s) {
  const gd_real step_var = s->segment.sum_squares / (gd_real)(s->segment.blocks - 1);
  return gd_max(GD_MIN_VAR, gd_min(s->noise.sample_var, GD_R(0.25) * (gd_real)s->block.samples * step_var));
}

/* Updates the range of block means, the agreement of levels and the segment by the present block. */
static inline void gd_rl_take_mean(gd_restlevel *s, int is_stationary, gd_real mean_dps, gd_real seconds) {
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
  if (is_stationary) {
    gd_rl_take_block(segment, &s->noise, mean_dps, s->c.rate_ramp_dps_s * seconds, s->block.seconds);
    if (segment->blocks > 1) {
      segment->sensor_odds = gd_rl_sensor_odds(gd_rl_scatter_var(s));
    }
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
  const int is_short_start = !is_stationary && gd_rl_is_short_start(s, seconds);
  gd_rl_take_mean(s, is_stationary, mean_dps, seconds);
  ended->short_start_blocks = is_short_start ? (uint8_t)before.blocks : 0;
  if (is_short_start || (before.blocks >= GD_CONFIRMED_BLOCKS && s->segment.blocks < GD_CONFIRMED_BLOCKS)) {
    ended->mean_dps = before.mean_dps;
    ended->seconds = before.seconds;
    ended->sensor_odds = before.sensor_odds;
    ended->blocks_ago = 0;
    ended->ended_gradually = is_stationary && GD_ABS(step_dps) < GD_GRADUAL_DPS_S * seconds;
  }
  if (ended->blocks_ago < GD_NEVER) {
    ++ended->blocks_ago;
  }
}

#endif
