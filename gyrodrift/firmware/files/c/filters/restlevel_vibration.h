/* Restlevel: rests that are noisier than the sensor. Twin of restlevel/vibration.py. */
#ifndef GD_RESTLEVEL_VIBRATION_H
#define GD_RESTLEVEL_VIBRATION_H

#include "restlevel_kalman.h"
#include "restlevel_noise.h"

#define GD_VIBRATION_BLOCKS 10                   /* number of blocks that confirm a vibrating segment */
#define GD_VIBRATION_SPREAD GD_R(0.7)            /* of the logarithm of the variance of equally noisy blocks */
#define GD_VIBRATION_PRIOR_BLOCKS GD_R(2.0)     /* blocks of white noise that the variance of means begins with */
#define GD_WOBBLE_DPS GD_R(0.15)            /* largest sigma of block means, unless white noise explains more */
#define GD_VIBRATION_SHIFT_DPS GD_R(0.03)        /* between the bias in vibration and at rest */
#define GD_VIBRATION_SHIFT_S GD_R(10.0)          /* time for which it stays */
#define GD_VIBRATION_LEVEL_DPS GD_R(1.0)         /* median rate of the level segments of a moving vehicle */
#define GD_VIBRATION_SHARE GD_R(0.5)             /* odds of a rest in vibration over those of a quiet rest */
#define GD_LEAST_LEVEL_DENSITY GD_R(1e-12)

/* Whether the present segment is noisier than the sensor. */
static inline int gd_rl_is_vibrating(const gd_restlevel *s) {
#if GD_RESTLEVEL_VIBRATION
  return s->segment.is_vibrating;
#else
  (void)s;
  return 0;
#endif
}

#if GD_RESTLEVEL_VIBRATION

/* Whether a block that is not stationary is as noisy as the blocks before; their variance is updated. */
static inline int gd_rl_vibrates_steadily(gd_restlevel *s) {
  gd_rl_vibration *vibration = &s->vibration;
  const gd_real variance = s->noise.last_block_var;
  if (vibration->blocks > 0) {
    const gd_real away = GD_LOG(variance / vibration->sample_var);
    const gd_real sampling = GD_R(2.0) * GD_DROP_SIGMAS * GD_DROP_SIGMAS / gd_rl_independent(&s->block);
    if (away * away < GD_VIBRATION_SPREAD * GD_VIBRATION_SPREAD + sampling) {
      vibration->blocks = (uint8_t)(vibration->blocks < GD_NOISE_BLOCKS ? vibration->blocks + 1 : GD_NOISE_BLOCKS);
      vibration->sample_var *= GD_EXP(away / (gd_real)vibration->blocks);
      return 1;
    }
  }
  vibration->blocks = 1;
  vibration->sample_var = variance;
  return 0;
}

/* Updates the variance of block means by the steps of a vibrating segment; returns whether it may be a rest. */
static inline int gd_rl_follow_means(gd_restlevel *s) {
  const gd_real white_var = s->vibration.sample_var / (gd_real)s->block.samples;
  const gd_real blocks = GD_VIBRATION_PRIOR_BLOCKS + (gd_real)s->segment.blocks - GD_R(1.0);
  s->vibration.mean_var = (GD_VIBRATION_PRIOR_BLOCKS * white_var + GD_R(0.5) * s->segment.sum_squares) / blocks;
  return s->vibration.mean_var < gd_max(GD_WOBBLE_DPS * GD_WOBBLE_DPS, white_var);
}

/* Whether the present segment is as noisy as the last one. */
static inline int gd_rl_resumes(const gd_restlevel *s) {
  if (!s->segment.is_vibrating) {
    return !s->ended.is_vibrating;
  }
  return s->ended.is_vibrating &&
         GD_ABS(GD_LOG(s->vibration.sample_var / s->vibration.ended_var)) < GD_VIBRATION_SPREAD;
}

/* Prior odds of a rest in vibration: the more motions were as noisy, the less. */
static inline gd_real gd_rl_vibration_odds(const gd_restlevel *s, gd_real rest_odds) {
  const int is_like = s->vibration.sample_var > GD_EXP(-GD_VIBRATION_SPREAD) * s->vibration.motion_var;
  return rest_odds * GD_VIBRATION_SHARE / (GD_R(1.0) + (is_like ? s->vibration.motions : GD_R(0.0)));
}

/* Density of the level of a vibrating segment if it is a rest, 1/(deg/s). */
static inline gd_real gd_rl_level_density(const gd_restlevel *s, const gd_rl_hypothesis *h) {
  const gd_real level_var = s->vibration.mean_var / (gd_real)s->segment.blocks;
  const gd_real variance = h->bias_var + level_var + GD_VIBRATION_SHIFT_DPS * GD_VIBRATION_SHIFT_DPS;
  return gd_max(GD_LEAST_LEVEL_DENSITY, GD_EXP(gd_rl_gaussian_logpdf(s->segment.mean_dps - h->bias_dps, variance)));
}

/* Counts a vibrating segment that has ended by the probability that it was a motion. */
static inline void gd_rl_count_motion(gd_restlevel *s) {
  gd_rl_vibration *vibration = &s->vibration;
  gd_real moving = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    moving += s->hypotheses[k].is_at_rest ? GD_R(0.0) : s->hypotheses[k].weight;
  }
  if (moving > GD_R(0.0)) {
    const gd_real before_var = vibration->motion_var == GD_R(0.0) ? s->vibration.ended_var : vibration->motion_var;
    vibration->motions += moving;
    vibration->motion_var = before_var * GD_POW(s->vibration.ended_var / before_var, moving / vibration->motions);
  }
}

#endif

/* Updates the means of a vibrating segment; returns whether the segment may be a rest. */
static inline int gd_rl_may_rest(gd_restlevel *s) {
#if GD_RESTLEVEL_VIBRATION
  if (s->segment.is_vibrating) {
    return gd_rl_follow_means(s);
  }
#endif
  (void)s;
  return 1;
}

/* Whether the block belongs to a segment: it is stationary, or as noisy as the blocks before. */
static inline int gd_rl_belongs_to_segment(gd_restlevel *s, int is_stationary, int may_vibrate) {
#if GD_RESTLEVEL_VIBRATION
  if (!may_vibrate) {
    s->vibration.blocks = 0;
  }
  if (!is_stationary && !(may_vibrate && gd_rl_vibrates_steadily(s))) {
    return 0;
  }
  if (s->segment.is_vibrating != may_vibrate) {
    s->segment.is_vibrating = may_vibrate != 0;
    s->segment.blocks = 0;
  }
  return 1;
#else
  (void)s, (void)may_vibrate;
  return is_stationary;
#endif
}

#endif
