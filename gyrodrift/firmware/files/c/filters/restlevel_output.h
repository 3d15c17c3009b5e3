/* Restlevel: the output after a sample, between the ends of blocks. */
#ifndef GD_RESTLEVEL_OUTPUT_H
#define GD_RESTLEVEL_OUTPUT_H

#include "restlevel_model.h"

/* Time from the last estimates up to the last sample: the present block, and one that is still worked on. */
static inline gd_real gd_rl_elapsed_s(const gd_restlevel *s) {
#if GD_RESTLEVEL_WORK
  if (s->work.stage > GD_RL_FINISH) {
    return (gd_real)(s->sums.seconds + s->block.seconds);
  }
#endif
  return (gd_real)s->GD_RL_SUMS.seconds;
}

/* Yaw at the last sample by the last estimates, without `base_deg`. */
static inline gd_real gd_rl_expected_deg(const gd_restlevel *s) {
#if GD_RESTLEVEL_WORK
  const gd_real angle_deg = s->sums.angle_deg + (s->work.stage > GD_RL_FINISH ? s->block.angle_deg : GD_R(0.0));
#else
  const gd_real angle_deg = s->block.angle_deg;
#endif
  return s->moments.yaw_deg + angle_deg - s->bias_dps * gd_rl_elapsed_s(s);
}

/* Variance of yaw by the errors of the scale factor, at this yaw without `base_deg`. */
static inline gd_real gd_rl_scale_var(const gd_restlevel *s, gd_real yaw_deg) {
  const gd_real net_deg = yaw_deg - s->start_yaw_deg;
  return s->c.scale_sigma * s->c.scale_sigma * (net_deg * net_deg + GD_TURN_DEG * s->travelled_deg);
}

/* Sets yaw and its sigma after a sample, part way through a block. */
static inline void gd_rl_set_yaw(gd_restlevel *s) {
  const gd_rl_moments *m = &s->moments;
  const gd_real seconds = gd_rl_elapsed_s(s);
  const gd_real yaw_deg = gd_rl_expected_deg(s);
  const gd_real scale_var = gd_rl_scale_var(s, yaw_deg);
  const gd_real angle_walk_var = gd_max(GD_R(0.0), s->noise.angle_walk_var);
  const gd_real moving_var = seconds * (m->bias_var * seconds - GD_R(2.0) * m->covariance + angle_walk_var);
  const gd_real yaw_var = m->yaw_var + moving_var + scale_var;
  s->yaw_deg = GD_IS_FLOAT ? s->base_deg + yaw_deg : yaw_deg;
  s->yaw_sigma_deg = GD_SQRT(gd_max(GD_R(0.0), GD_IS_FLOAT ? gd_min(GD_R(1e38), yaw_var) : yaw_var));
}

/* Stores a step of yaw that is no motion, and counts it if it is large. */
static inline void gd_rl_count_correction(gd_restlevel *s, gd_real base_deg, gd_real expected_deg) {
  s->correction_deg = s->moments.yaw_deg - expected_deg + (s->base_deg - base_deg);
  if (GD_ABS(s->correction_deg) > GD_CORRECTION_DEG && s->corrections < UINT8_MAX) {
    ++s->corrections;
  }
}

#endif
