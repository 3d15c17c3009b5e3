/* Restlevel: a rest by an external sensor. Twin of `stand_still` in restlevel/witness.py. */
#ifndef GD_RESTLEVEL_STILL_H
#define GD_RESTLEVEL_STILL_H

#include "restlevel_witness.h"

#if GD_RESTLEVEL_AUXILIARY

/* Begins the update by a certain rest. */
static inline void gd_rl_begin_still(gd_restlevel *s, gd_rl_still *b, gd_real mean_dps, gd_real seconds) {
  b->mean_dps = mean_dps;
  b->mean_var = gd_rl_noisy_mean_var(s, seconds);
  b->flicker_var = s->noise.flicker_var;
  b->ramp_var = s->c.rate_ramp_dps_s * s->c.rate_ramp_dps_s * seconds * seconds;
  if (!s->noise.is_walk_measured) {
    s->noise.sample_var = s->noise.last_block_var;
    s->noise.angle_walk_var = b->mean_var * seconds;
  }
}

/* Sets `odds` of a hypothesis to the log-likelihood of the block mean. */
static inline void gd_rl_compare_still(const gd_restlevel *s, gd_rl_hypothesis *h, const gd_rl_still *b,
                                       gd_real seconds) {
  const gd_real drift_dps = s->c.rate_ramp_dps_s * (h->is_at_rest ? seconds : gd_min(h->moving_s, GD_MAX_RAMP_S));
  h->odds = gd_rl_gaussian_logpdf(b->mean_dps - h->bias_dps,
                                  h->bias_var + drift_dps * drift_dps + b->mean_var + b->flicker_var);
}

/* Updates a hypothesis; returns its squared innovation minus the expected value, times its weight, (deg/s)^2. */
static inline gd_real gd_rl_update_still(gd_restlevel *s, gd_rl_hypothesis *h, const gd_rl_still *b, gd_real best) {
  const gd_real innovation_dps = b->mean_dps - h->bias_dps;
  gd_real excess_var = GD_R(0.0);
  if (h->is_at_rest) {
    excess_var = h->weight * (innovation_dps * innovation_dps - h->bias_var - b->mean_var - b->flicker_var);
    gd_rl_kalman_update(h, b->mean_dps, b->mean_var, b->ramp_var);
  } else {
    gd_rl_first_kalman_update(&s->c, h, b->mean_dps, b->mean_var);
  }
  h->weight *= GD_EXP(h->odds - best);
  h->is_at_rest = 1;
  h->moving_s = GD_R(0.0);
  h->odds = h->rest_odds = GD_R(1.0);
  gd_rl_mark_safe(h);
  h->chance_density = h->noisy_density = GD_R(0.0);
  return excess_var;
}

/* Learns flicker and random walk once all hypotheses are updated by a certain rest. */
static inline void gd_rl_learn_still(gd_restlevel *s, const gd_rl_still *b, gd_real excess_var, gd_real step_dps,
                                     gd_real seconds) {
  if (s->witness.was_certain) {
    excess_var = gd_min(excess_var, GD_FLICKER_CLIP * (b->mean_var + b->flicker_var));
    gd_rl_learn_at_rest(s, GD_R(1.0), excess_var, step_dps, seconds);
  }
}

#endif

#endif
