/* Restlevel: rests that are louder than the sensor. Twin of restlevel/loud.py. */
#ifndef GD_RESTLEVEL_LOUD_H
#define GD_RESTLEVEL_LOUD_H

#include "restlevel_kalman.h"
#include "restlevel_noise.h"

#define GD_LOUD_BLOCKS 10                   /* number of blocks that confirm a loud segment */
#define GD_LOUD_SPREAD GD_R(0.7)            /* of the logarithm of the variance of equally loud blocks */
#define GD_LOUD_PRIOR_BLOCKS GD_R(2.0)      /* blocks of white noise that the variance of block means begins with */
#define GD_WOBBLE_DPS GD_R(0.15)            /* largest sigma of block means, unless white noise explains more */
#define GD_LOUD_SHIFT_DPS GD_R(0.03)        /* between the bias in vibration and at rest */
#define GD_LOUD_SHIFT_S GD_R(10.0)          /* time for which it stays */
#define GD_LOUD_LEVEL_DPS GD_R(1.0)         /* median rate of the level segments of a moving vehicle */
#define GD_LOUD_SHARE GD_R(0.5)             /* odds of a loud rest over those of a quiet rest */
#define GD_LEAST_LEVEL_DENSITY GD_R(1e-12)

/* Whether the present segment, and the last one, are louder than the sensor. */
static inline int gd_rl_is_loud(const gd_restlevel *s) {
#if GD_RESTLEVEL_LOUD
  return s->segment.is_loud;
#else
  (void)s;
  return 0;
#endif
}

#if GD_RESTLEVEL_LOUD

/* Whether a block that is not stationary is as loud as the blocks before; their variance is updated. */
static inline int gd_rl_is_steadily_loud(gd_restlevel *s) {
  gd_rl_loud *loud = &s->loud;
  const gd_real variance = s->noise.last_block_var;
  if (loud->blocks > 0) {
    const gd_real away = GD_LOG(variance / loud->sample_var);
    const gd_real sampling = GD_R(2.0) * GD_DROP_SIGMAS * GD_DROP_SIGMAS / gd_rl_independent(&s->block);
    if (away * away < GD_LOUD_SPREAD * GD_LOUD_SPREAD + sampling) {
      loud->blocks = (uint8_t)(loud->blocks < GD_NOISE_BLOCKS ? loud->blocks + 1 : GD_NOISE_BLOCKS);
      loud->sample_var *= GD_EXP(away / (gd_real)loud->blocks);
      return 1;
    }
  }
  loud->blocks = 1;
  loud->sample_var = variance;
  return 0;
}

/* Updates the variance of block means by the steps of the present loud segment; returns whether it may be a rest. */
static inline int gd_rl_follow_means(gd_restlevel *s) {
  const gd_real white_var = s->loud.sample_var / (gd_real)s->block.samples;
  const gd_real blocks = GD_LOUD_PRIOR_BLOCKS + (gd_real)s->segment.blocks - GD_R(1.0);
  s->loud.mean_var = (GD_LOUD_PRIOR_BLOCKS * white_var + GD_R(0.5) * s->segment.sum_squares) / blocks;
  return s->loud.mean_var < gd_max(GD_WOBBLE_DPS * GD_WOBBLE_DPS, white_var);
}

/* Whether the present segment is as loud as the last one. */
static inline int gd_rl_resumes(const gd_restlevel *s) {
  if (!s->segment.is_loud) {
    return !s->ended.is_loud;
  }
  return s->ended.is_loud && GD_ABS(GD_LOG(s->loud.sample_var / s->ended.sample_var)) < GD_LOUD_SPREAD;
}

/* Prior odds of a loud rest: the more motions were as loud, the less. */
static inline gd_real gd_rl_loud_odds(const gd_restlevel *s, gd_real rest_odds) {
  const int is_like = s->loud.sample_var > GD_EXP(-GD_LOUD_SPREAD) * s->loud.motion_var;
  return rest_odds * GD_LOUD_SHARE / (GD_R(1.0) + (is_like ? s->loud.motions : GD_R(0.0)));
}

/* Density of the level of a loud segment if it is a rest, 1/(deg/s). */
static inline gd_real gd_rl_level_density(const gd_restlevel *s, const gd_rl_hypothesis *h) {
  const gd_real level_var = s->loud.mean_var / (gd_real)s->segment.blocks;
  const gd_real variance = h->bias_var + level_var + GD_LOUD_SHIFT_DPS * GD_LOUD_SHIFT_DPS;
  return gd_max(GD_LEAST_LEVEL_DENSITY, GD_EXP(gd_rl_gaussian_logpdf(s->segment.mean_dps - h->bias_dps, variance)));
}

/* Counts a loud segment that has ended by the probability that it was a motion. */
static inline void gd_rl_count_motion(gd_restlevel *s) {
  gd_rl_loud *loud = &s->loud;
  gd_real moving = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    moving += s->hypotheses[k].is_at_rest ? GD_R(0.0) : s->hypotheses[k].weight;
  }
  if (moving > GD_R(0.0)) {
    const gd_real before_var = loud->motion_var == GD_R(0.0) ? s->ended.sample_var : loud->motion_var;
    loud->motions += moving;
    loud->motion_var = before_var * GD_POW(s->ended.sample_var / before_var, moving / loud->motions);
  }
}

#endif

/* Updates the means of a loud segment; returns whether the segment may be a rest. */
static inline int gd_rl_may_rest(gd_restlevel *s) {
#if GD_RESTLEVEL_LOUD
  if (s->segment.is_loud) {
    return gd_rl_follow_means(s);
  }
#endif
  (void)s;
  return 1;
}

/* Whether the block belongs to a segment: it is stationary, or as loud as the blocks before. */
static inline int gd_rl_belongs_to_segment(gd_restlevel *s, int is_stationary, int may_be_loud) {
#if GD_RESTLEVEL_LOUD
  if (!may_be_loud) {
    s->loud.blocks = 0;
  }
  if (!is_stationary && !(may_be_loud && gd_rl_is_steadily_loud(s))) {
    return 0;
  }
  if (s->segment.is_loud != may_be_loud) {
    s->segment.is_loud = may_be_loud != 0;
    s->segment.blocks = 0;
  }
  return 1;
#else
  (void)s, (void)may_be_loud;
  return is_stationary;
#endif
}

#endif
