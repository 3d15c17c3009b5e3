/* Restlevel: a sensor with noise that repeats a single value. Twin of restlevel/frozen.py. */
#ifndef GD_RESTLEVEL_FROZEN_H
#define GD_RESTLEVEL_FROZEN_H

#include "restlevel_noise.h"

#define GD_NOISE_STEPS GD_R(2.0) /* noise in steps of the sensor above which a repeated value is no chance */

/* Sets whether the sensor repeated a single value through the present block. */
static inline void gd_rl_detect_freeze(gd_restlevel *s) {
  gd_rl_noise *noise = &s->noise;
  const gd_real step_dps = noise->resolution_dps;
  const int is_noisy =
      noise->is_walk_measured && noise->sample_var > GD_NOISE_STEPS * GD_NOISE_STEPS * step_dps * step_dps;
  const int is_zero = s->block.origin_dps == GD_R(0.0) && s->bias_dps * s->bias_dps <= noise->sample_var;
  noise->is_frozen = s->block.sum_squares == GD_R(0.0) && is_noisy && GD_R(0.0) < step_dps &&
                     step_dps <= GD_FINE_DPS && !is_zero;
  if (noise->is_frozen) {
    noise->has_dropped = 0;
    noise->last_block_var = noise->sample_var;
  } else {
    noise->frozen_deg = GD_R(0.0);
  }
}

/* Adds the angle of a frozen sensor since its first repetition to the sigma of yaw, as a single error. */
static inline void gd_rl_widen_yaw(gd_restlevel *s, gd_real seconds) {
  gd_rl_noise *noise = &s->noise;
  const gd_real before_deg = noise->frozen_deg;
  gd_real more_var;
  uint8_t k;
  if (!noise->is_frozen) {
    return;
  }
  noise->frozen_deg += GD_ABS(s->block.angle_deg - s->bias_dps * seconds);
  more_var = noise->frozen_deg * noise->frozen_deg - before_deg * before_deg;
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].yaw_var += more_var;
  }
}

#endif
