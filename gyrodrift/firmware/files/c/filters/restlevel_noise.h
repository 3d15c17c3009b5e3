/* Restlevel: noise of the sensor, and whether a block shows more than that. Twin of restlevel/noise.py. */
#ifndef GD_RESTLEVEL_NOISE_H
#define GD_RESTLEVEL_NOISE_H

#include "restlevel_model.h"

#define GD_MIN_VAR GD_R(1e-12)          /* of samples, (deg/s)^2 */
#define GD_UNKNOWN_STEPS_VAR GD_R(0.0009) /* before the first step: half a step of coarse parts, squared */
#define GD_COARSEST_VAR GD_R(0.015625)  /* half a step of the coarsest part, squared */
#define GD_FINE_DPS GD_R(0.03)          /* a sensor of finer steps is never without noise at rest */
#define GD_START_BLOCKS 5               /* after so many blocks of one value, larger first steps are motion: */
#define GD_MAX_NOISE_VAR GD_R(1.44)     /* variance of a block, (deg/s)^2 */
#define GD_NOISE_BLOCKS 20              /* number up to which the noise is their mean; later NOISE_GAIN */
#define GD_NOISE_GAIN GD_R(0.01)
#define GD_NOISE_RISE GD_R(0.001)       /* relative rise in a second of motion */
#define GD_DROP_SIGMAS GD_R(4.5)        /* two consecutive blocks so far below the noise replace it */
#define GD_USUAL_NOISE_DPS GD_R(0.06)   /* usual noise of a sample, and spread of its logarithm over parts */
#define GD_NOISE_SPREAD GD_R(1.0)
#define GD_LOG_USUAL_NOISE GD_R(-2.8134107167600364)
#define GD_MOTION_DENSITY GD_R(0.11)    /* density of the logarithm of the scatter in motion */
#define GD_WALK_GAIN GD_R(0.05)
#define GD_INNOVATION_CLIP GD_R(9.0)    /* largest ratio of a squared step of block means to its expected value */
#define GD_FLICKER_GAIN GD_R(0.002)
#define GD_FLICKER_CLIP GD_R(4.0)

/* Variance that steps of the resolution may hide. */
static inline gd_real gd_rl_rounding_var(const gd_rl_noise *noise) {
  if (!noise->has_steps) {
    return GD_UNKNOWN_STEPS_VAR;
  }
  return gd_min(GD_R(0.25) * noise->resolution_dps * noise->resolution_dps, GD_COARSEST_VAR);
}

/* Variance of the samples of a block, at least the variance that rounding may hide. */
static inline gd_real gd_rl_variance(const gd_rl_block *block, const gd_rl_noise *noise) {
  const gd_real samples = (gd_real)block->samples, mean_dps = block->sum_dps / samples;
  const gd_real scatter = block->sum_squares / samples - mean_dps * mean_dps;
  return gd_max(gd_max(scatter, gd_rl_rounding_var(noise)), GD_MIN_VAR);
}

/* Number of independent samples of a block: all, unless most repeat the one before; two are the least. */
static inline gd_real gd_rl_independent(const gd_rl_block *block) {
  const uint32_t fresh = block->samples - block->repeats;
  if (2 * block->repeats < block->samples) {
    return (gd_real)block->samples;
  }
  return (gd_real)(fresh < 2 ? 2 : fresh);
}

/* Forgets the variance of samples, because the sensor shows its steps from now on. */
static inline void gd_rl_forget_blocks(gd_rl_noise *noise) {
  noise->sample_var = noise->last_block_var = GD_R(-1.0);
  noise->stationary_blocks = 0;
  noise->has_steps = 1;
  noise->is_walk_measured = 0;
}

/* Updates the noise by a block: it is stationary if its variance is below the limit. */
static inline void gd_rl_follow_noise(gd_rl_noise *noise, gd_real variance, gd_real limit, gd_real seconds) {
  if (noise->has_dropped) {
    noise->sample_var = gd_max(variance, noise->last_block_var);
  } else if (variance < noise->sample_var * limit) {
    if (noise->stationary_blocks < GD_NOISE_BLOCKS) {
      ++noise->stationary_blocks;
    }
    if (noise->stationary_blocks < GD_NOISE_BLOCKS) {
      noise->sample_var += (variance - noise->sample_var) / (gd_real)noise->stationary_blocks;
    } else {
      noise->sample_var *= GD_POW(variance / noise->sample_var, GD_NOISE_GAIN);
    }
  } else {
    noise->sample_var *= GD_R(1.0) + GD_NOISE_RISE * seconds;
  }
}

/* Whether the present block shows no more than the noise of the sensor. The block also updates the noise. */
static inline int gd_rl_is_stationary(gd_restlevel *s, gd_real seconds) {
  const gd_rl_block *block = &s->block;
  gd_rl_noise *noise = &s->noise;
  const int is_starting = noise->stationary_blocks < GD_START_BLOCKS;
  gd_real variance = gd_rl_variance(block, noise), error, limit;
  if (noise->resolution_dps > GD_R(0.0) && !noise->has_steps && (is_starting || variance < GD_MAX_NOISE_VAR)) {
    gd_rl_forget_blocks(noise);
    variance = gd_rl_variance(block, noise);
  }
  error = GD_SQRT(GD_R(2.0) / gd_rl_independent(block)); /* relative standard error of a variance */
  if (noise->sample_var < GD_R(0.0)) {
    noise->sample_var = variance;
  }
  limit = GD_R(1.0) + s->c.stationarity_sigmas * error *
                          GD_SQRT(GD_R(1.0) + GD_R(1.0) / gd_max((gd_real)noise->stationary_blocks, GD_R(1.0)));
  noise->has_dropped =
      gd_max(variance, noise->last_block_var) < noise->sample_var * GD_EXP(-GD_DROP_SIGMAS * error);
  gd_rl_follow_noise(noise, variance, limit, seconds);
  noise->last_block_var = variance;
  if (!noise->is_walk_measured) {
    noise->angle_walk_var = GD_R(2.0) * noise->sample_var / gd_rl_independent(block) * seconds;
  }
  return variance < noise->sample_var * limit;
}

/* Whether the present block is the first with rates of a fine sensor that repeated one value before. */
static inline int gd_rl_begins_to_measure(gd_rl_noise *noise) {
  if (noise->resolution_dps < GD_R(0.0)) {
    noise->same_blocks = 1;
    return 0;
  }
  if (noise->same_blocks > 0) {
    noise->same_blocks = -GD_START_BLOCKS;
  }
  if (noise->same_blocks < 0 && noise->resolution_dps <= GD_FINE_DPS) {
    noise->same_blocks = 0;
    return 1;
  }
  noise->same_blocks = (int8_t)(noise->same_blocks < 0 ? noise->same_blocks + 1 : 0);
  return 0;
}

static inline void gd_rl_forget_noise(gd_rl_noise *noise) {
  gd_rl_forget_blocks(noise);
  noise->angle_walk_var = GD_R(-1.0);
  noise->flicker_var = GD_R(0.0);
}

/* Likelihood ratio of a variance of samples: sensor at rest against motion. */
static inline gd_real gd_rl_sensor_odds(gd_real sample_var) {
  const gd_real beyond = (GD_R(0.5) * GD_LOG(sample_var) - GD_LOG_USUAL_NOISE) / GD_NOISE_SPREAD;
  const gd_real away = gd_max(beyond, GD_R(0.0)); /* a quiet sensor is no evidence against rest */
  return gd_min(GD_R(1.0), GD_R(0.4) / GD_NOISE_SPREAD * GD_EXP(GD_R(-0.5) * away * away) / GD_MOTION_DENSITY);
}

/* Updates flicker and angle random walk by a block at rest. */
static inline void gd_rl_learn_at_rest(gd_restlevel *s, gd_real rest_weight, gd_real excess_var, gd_real step_dps,
                                       gd_real seconds) {
  gd_rl_noise *noise = &s->noise;
  gd_real seen_var, walk_var;
  noise->flicker_var = gd_max(GD_R(0.0), noise->flicker_var + GD_FLICKER_GAIN * excess_var);
  noise->is_walk_measured = noise->is_walk_measured || rest_weight > GD_R(0.5);
  seen_var = gd_min(GD_R(0.5) * step_dps * step_dps * seconds, GD_INNOVATION_CLIP * noise->angle_walk_var);
  walk_var = noise->angle_walk_var + GD_WALK_GAIN * rest_weight * (seen_var - noise->angle_walk_var);
  noise->angle_walk_var = gd_max(walk_var, gd_rl_rounding_var(noise) / gd_rl_independent(&s->block) * seconds);
}

#endif
