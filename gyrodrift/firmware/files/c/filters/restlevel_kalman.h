/* Restlevel: zero-velocity updates of yaw and bias. Twin of restlevel/kalman.py. */
#ifndef GD_RESTLEVEL_KALMAN_H
#define GD_RESTLEVEL_KALMAN_H

#include "restlevel_model.h"

#define GD_MAX_LOG_ODDS (GD_IS_FLOAT ? GD_R(85.0) : GD_R(700.0)) /* beyond it exp() is infinite */

/* Corrections of the mean, and the covariance after a measurement of the bias. */
typedef struct {
  gd_real bias_dps, yaw_deg, bias_var, covariance, yaw_var;
} gd_rl_kalman;

/* Update by a block mean at rest with variance `mean_var`. */
static inline gd_rl_kalman gd_rl_kalman_step(gd_real innovation_dps, gd_real bias_var, gd_real covariance,
                                             gd_real yaw_var, gd_real mean_var) {
  const gd_real gain = bias_var / (bias_var + mean_var), yaw_gain_s = covariance / (bias_var + mean_var);
  gd_rl_kalman k;
  k.bias_dps = gain * innovation_dps;
  k.yaw_deg = yaw_gain_s * innovation_dps;
  k.bias_var = bias_var * (GD_R(1.0) - gain);
  k.covariance = covariance * (GD_R(1.0) - gain);
  k.yaw_var = yaw_var - yaw_gain_s * covariance;
  return k;
}

static inline gd_real gd_rl_gaussian_logpdf(gd_real x, gd_real variance) {
  return GD_R(-0.5) * (x * x / variance + GD_LOG(GD_R(2.0) * GD_PI * variance));
}

/* Moves a hypothesis to the moments of the mixture of two posteriors; `share` is the weight of the second. */
static inline void gd_rl_mix(gd_rl_hypothesis *h, const gd_rl_kalman *first, const gd_rl_kalman *second,
                             gd_real share) {
  const gd_real apart_dps = second->bias_dps - first->bias_dps, apart_deg = second->yaw_deg - first->yaw_deg;
  const gd_real spread = share * (GD_R(1.0) - share);
  h->bias_dps += first->bias_dps + share * apart_dps;
  h->yaw_deg += first->yaw_deg + share * apart_deg;
  h->bias_var = first->bias_var + share * (second->bias_var - first->bias_var) + spread * apart_dps * apart_dps;
  h->covariance =
      first->covariance + share * (second->covariance - first->covariance) + spread * apart_dps * apart_deg;
  h->yaw_var = first->yaw_var + share * (second->yaw_var - first->yaw_var) + spread * apart_deg * apart_deg;
}

/* Updates a hypothesis by a block mean at rest, under the random walk and the ramp of the bias.

   `ramp_var` is what a ramp has added to the bias since the last rest. It grew evenly, so that yaw is off by half of it
   times that time. Returns the logarithm of the likelihood. */
static inline gd_real gd_rl_kalman_update(gd_rl_hypothesis *h, gd_real mean_dps, gd_real mean_var, gd_real ramp_var) {
  const gd_real innovation_dps = mean_dps - h->bias_dps, half_s = GD_R(0.5) * h->moving_s;
  const gd_real ramp_bias_var = h->bias_var + ramp_var, ramp_covariance = h->covariance - ramp_var * half_s;
  const gd_real ramp_yaw_var = h->yaw_var + ramp_var * half_s * half_s;
  const gd_real walk_logpdf = gd_rl_gaussian_logpdf(innovation_dps, h->bias_var + mean_var);
  const gd_real ramp_logpdf = gd_rl_gaussian_logpdf(innovation_dps, ramp_bias_var + mean_var);
  const gd_real walk_odds =
      GD_EXP(gd_max(-GD_MAX_LOG_ODDS, gd_min(walk_logpdf - ramp_logpdf, GD_MAX_LOG_ODDS)));
  const gd_real evidence = GD_RAMP_PROBABILITY + (GD_R(1.0) - GD_RAMP_PROBABILITY) * walk_odds;
  const gd_rl_kalman walk = gd_rl_kalman_step(innovation_dps, h->bias_var, h->covariance, h->yaw_var, mean_var);
  const gd_rl_kalman ramp =
      gd_rl_kalman_step(innovation_dps, ramp_bias_var, ramp_covariance, ramp_yaw_var, mean_var);
  gd_rl_mix(h, &walk, &ramp, GD_RAMP_PROBABILITY / evidence);
  return ramp_logpdf + GD_LOG(evidence);
}

/* Updates a hypothesis at the beginning of a rest. Without an earlier rest, the bias has the prior of the turn-on
   bias. */
static inline gd_real gd_rl_first_kalman_update(const gd_rl_coefficients *c, gd_rl_hypothesis *h, gd_real mean_dps,
                                                gd_real mean_var) {
  gd_real log_likelihood;
  if (h->knows_bias) {
    const gd_real ramp_dps = c->rate_ramp_dps_s * gd_min(h->moving_s, GD_MAX_RAMP_S);
    log_likelihood = gd_rl_kalman_update(h, mean_dps, mean_var, ramp_dps * ramp_dps);
  } else {
    log_likelihood = gd_rl_kalman_update(h, mean_dps, mean_var, GD_R(0.0));
    h->knows_bias = 1;
  }
  h->moving_s = GD_R(0.0);
  return log_likelihood;
}

#endif
