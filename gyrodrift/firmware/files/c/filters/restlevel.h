/* Restlevel on one axis: learns the bias at each rest, corrects yaw backwards, and says how sure it is.

   The same filter as gyrodrift/filters/restlevel, whose docs/restlevel.md has the equations. Of doubles, it gives the
   same bits. It remembers nothing from one run to the next but by a copy of its state.
*/
#ifndef GD_RESTLEVEL_H
#define GD_RESTLEVEL_H

#include "restlevel_gap.h"

#define GD_LEAST_VAR GD_R(1e-24) /* of the turn-on bias, (deg/s)^2 */
#define GD_MIN_BLOCK_SAMPLES 6   /* the variance of fewer samples is too uncertain */

static inline void gd_rl_set_coefficients(gd_rl_coefficients *c, const gd_restlevel_params *p) {
  const gd_real turn_on_var = p->turn_on_dps * p->turn_on_dps;
  c->window_s = (double)p->window_s;
  c->stationarity_sigmas = p->quiet;
  c->turn_on_var = p->turn_on_dps > GD_R(0.0) ? gd_max(GD_LEAST_VAR, turn_on_var) : GD_R(0.0);
  c->rate_walk_var = p->walk_dps_rts * p->walk_dps_rts;
  c->rate_ramp_dps_s = p->drift_dps_s;
  c->start_odds = p->still_start / (GD_R(1.0) - p->still_start);
  c->rest_odds = p->rest_share / (GD_R(1.0) - p->rest_share);
  c->scale_sigma = p->scale_percent / GD_R(100.0);
}

/* Begins. NULL stands for the defaults, which are also used if a parameter is out of its bounds: then it returns 0. */
static inline int gd_restlevel_init(gd_restlevel *s, const gd_restlevel_params *params) {
  const gd_restlevel_params defaults = GD_RESTLEVEL_DEFAULTS;
  const int is_valid = params == NULL || gd_restlevel_params_are_valid(params);
  memset(s, 0, sizeof *s);
  gd_rl_set_coefficients(&s->c, params != NULL && is_valid ? params : &defaults);
  s->confidence = GD_R(1.0);
  s->noise.sample_var = s->noise.last_block_var = s->noise.angle_walk_var = GD_R(-1.0);
  s->resolution_dps = s->noise.resolution_dps = GD_R(-1.0);
  s->segment.sensor_odds = s->ended.sensor_odds = GD_R(1.0);
  s->ended.blocks_ago = GD_NEVER;
  s->wander.step_dps = GD_UNKNOWN_STEP_DPS;
#if GD_RESTLEVEL_GAPS
  s->longest_step_s = GD_FIRST_STEP_S;
#endif
#if GD_RESTLEVEL_AUXILIARY
  s->temp_c = GD_UNKNOWN_C;
  gd_begin_line(&s->line);
  s->witness.is_believed = 1;
#endif
  return is_valid;
}

static inline void gd_rl_add_sample(gd_restlevel *s, double dt_s, gd_real rate_dps) {
  gd_rl_block *block = &s->GD_RL_SUMS;
  const gd_real step_dps = GD_ABS(rate_dps - s->rate_dps);
  gd_real above_dps;
  if (step_dps > GD_R(0.0) && (step_dps < s->resolution_dps || s->resolution_dps < GD_R(0.0))) {
    s->resolution_dps = step_dps;
  }
  if (block->samples == 0) {
    block->origin_dps = rate_dps;
  }
  above_dps = rate_dps - block->origin_dps;
  block->seconds += dt_s;
  gd_count(&block->samples);
  if (!(step_dps > GD_R(0.0)) && s->resolution_dps > GD_R(0.0) && s->resolution_dps <= GD_FINE_DPS) {
    gd_count(&block->repeats);
  }
  block->sum_dps += above_dps;
  block->sum_squares += above_dps * above_dps;
  block->angle_deg += GD_R(0.5) * (rate_dps + s->rate_dps) * (gd_real)dt_s;
  s->rate_dps = rate_dps;
  gd_count(&s->samples);
}

/* Advances the state by a valid sample, `dt_s` after the sample before; 0 for the first. */
static inline void gd_rl_advance(gd_restlevel *s, double dt_s, gd_real rate_dps) {
  s->correction_deg = GD_R(0.0);
  if (dt_s < 0.0) { /* the sample waits */
    gd_count(&s->samples);
    return;
  }
  if (s->samples == 0) {
    s->start_yaw_deg = s->yaw_deg;
    s->rate_dps = rate_dps;
    gd_rl_begin(s, s->yaw_deg);
  }
#if GD_RESTLEVEL_GAPS
  if (s->samples > 0 && dt_s > s->longest_step_s) {
    gd_real expected_deg;
    gd_rl_catch_up(s);
    expected_deg = gd_rl_expected_deg(s);
    gd_rl_pass_gap(s, dt_s, rate_dps);
    gd_rl_count_correction(s, s->base_deg, expected_deg);
    dt_s = 0.0;
  }
#endif
  gd_rl_add_sample(s, dt_s, rate_dps);
  if (s->GD_RL_SUMS.seconds > s->c.window_s - GD_SAME_TIME_S && s->GD_RL_SUMS.samples >= GD_MIN_BLOCK_SAMPLES) {
    gd_rl_end_block(s);
  }
  gd_rl_set_yaw(s);
}

/* Whether the next sample may have any time. */
static inline int gd_rl_has_restarted(const gd_restlevel *s) {
#if GD_RESTLEVEL_GAPS
  return s->longest_step_s < GD_TOLD_GAP;
#else
  (void)s;
  return 0;
#endif
}

/* Whether a sample is taken; else it is counted. `dt_s` is the step from the sample before; after a restart the clock
   may have restarted too. */
static inline int gd_rl_accepts(gd_restlevel *s, double t_s, double *dt_s, gd_real rate_dps) {
  if (gd_rl_has_restarted(s) && !(*dt_s >= GD_LEAST_STEP_S)) {
    *dt_s = GD_LEAST_STEP_S;
  }
  if (gd_is_within(t_s, rate_dps) && (s->samples == 0 || *dt_s >= GD_LEAST_STEP_S)) {
#if GD_RESTLEVEL_AUXILIARY && GD_RESTLEVEL_GAPS
    if (*dt_s > s->longest_step_s) { /* the sample begins a block, of which the rest sensor has said nothing yet */
      s->witness.is_moving = s->witness.is_silent = 0;
    }
#endif
    return 1;
  }
  gd_count(&s->rejected);
  return 0;
}

/* The same by the clock of microseconds; the step of a sample that waits is below 0. Where the rule for gaps is left
   out, yaw is held over a pause of more than 10 s. */
static inline int gd_rl_accepts_us(gd_restlevel *s, uint32_t t_us, double *dt_s, gd_real rate_dps) {
  const double step_s = gd_step_of_us(t_us, s->t_us, &s->suspect_us);
  const int waits = step_s < 0.0 && s->samples > 0 && !gd_rl_has_restarted(s);
  *dt_s = waits || (!GD_RESTLEVEL_GAPS && step_s > GD_FAR_S) ? GD_LEAST_STEP_S : step_s;
  if (!gd_rl_accepts(s, 0.0, dt_s, rate_dps)) {
    return 0;
  }
  if (waits) {
    *dt_s = step_s;
  } else {
    s->t_us = s->suspect_us = t_us;
  }
  return 1;
}

/* Takes an accepted sample without a rest sensor and a temperature. */
static inline void gd_rl_advance_alone(gd_restlevel *s, double dt_s, gd_real rate_dps) {
#if GD_RESTLEVEL_AUXILIARY
  s->witness.is_silent = 1;
#endif
  gd_rl_advance(s, s->samples > 0 ? dt_s : 0.0, rate_dps);
}

/* Takes a sample: device time in s and rate in deg/s, counter-clockwise positive.

   Returns 0 if the sample is refused: time stands still or goes back, or a value is not finite or out of its limits.
*/
static inline int gd_restlevel_update(gd_restlevel *s, double t_s, gd_real rate_dps) {
  double dt_s = t_s - s->t_s;
  if (!gd_rl_accepts(s, t_s, &dt_s, rate_dps)) {
    return 0;
  }
  s->t_s = t_s;
  gd_rl_advance_alone(s, dt_s, rate_dps);
  return 1;
}

/* The same by a clock of microseconds that wraps, as micros() of Arduino. Use one of the clocks. */
static inline int gd_restlevel_update_us(gd_restlevel *s, uint32_t t_us, gd_real rate_dps) {
  double dt_s;
  if (!gd_rl_accepts_us(s, t_us, &dt_s, rate_dps)) {
    return 0;
  }
  gd_rl_advance_alone(s, dt_s, rate_dps);
  return 1;
}

#if GD_RESTLEVEL_WORK

/* Does a portion of the work at the end of a block; returns whether more is left. Call it between samples, as often as
   there is time: then gd_restlevel_update only sums up, and the estimates follow some samples later. What is left when
   the next block ends, gd_restlevel_update does itself. Without any call it does all the work, at the last sample of a
   block. The results are the same bits in each case. */
static inline int gd_restlevel_work(gd_restlevel *s) {
  s->work.is_divided = 1;
  if (s->work.stage == GD_RL_IDLE) {
    return 0;
  }
  gd_rl_do_portion(s, &s->work);
  if (s->work.stage != GD_RL_IDLE) {
    return 1;
  }
  gd_rl_set_yaw(s);
  return 0;
}

#endif

#endif
