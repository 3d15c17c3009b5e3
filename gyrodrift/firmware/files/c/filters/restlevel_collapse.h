/* Restlevel: all hypotheses as one Gaussian. Twin of `collapse` in restlevel/mixture.py. */
#ifndef GD_RESTLEVEL_COLLAPSE_H
#define GD_RESTLEVEL_COLLAPSE_H

#include "restlevel_mixture.h"

/* Computes the means, weighted by the cubes of the probabilities, so that improbable hypotheses hardly count. */
static inline void gd_rl_collapse_means(gd_restlevel *s) {
  gd_real total = GD_R(0.0), yaw_deg = GD_R(0.0), bias_dps = GD_R(0.0), rest_weight = GD_R(0.0), most = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    const gd_rl_hypothesis *h = &s->hypotheses[k];
    const gd_real share = h->weight * h->weight * h->weight;
    total += share;
    yaw_deg += share * h->yaw_deg;
    bias_dps += share * h->bias_dps;
    most = gd_max(most, h->weight);
    if (h->is_at_rest) {
      rest_weight += h->weight;
    }
  }
  s->moments.yaw_deg = yaw_deg / total;
  s->bias_dps = bias_dps / total;
  s->confidence = most;
  s->rest_probability = rest_weight;
}

/* Adds the covariance of a hypothesis about the mean, with the ramp that its bias may have followed since its rest. */
static inline void gd_rl_add_moments(const gd_restlevel *s, gd_rl_moments *m, const gd_rl_hypothesis *h,
                                     gd_real weight) {
  const gd_real apart_deg = h->yaw_deg - m->yaw_deg, apart_dps = h->bias_dps - s->bias_dps;
  m->yaw_var += weight * (h->yaw_var + apart_deg * apart_deg);
  m->covariance += weight * (h->covariance + apart_deg * apart_dps);
  m->bias_var += weight * (h->bias_var + apart_dps * apart_dps);
  if (h->knows_bias && h->moving_s > GD_R(0.0)) {
    const gd_real ramp_dps = s->c.rate_ramp_dps_s * gd_min(h->moving_s, GD_MAX_RAMP_S);
    const gd_real seconds = gd_min(h->moving_s, s->travelled_s);
    const gd_real ramp_var = weight * GD_RAMP_PROBABILITY * ramp_dps * ramp_dps;
    const gd_real reach_s = seconds - GD_R(0.5) * seconds * seconds / h->moving_s;
    m->bias_var += ramp_var;
    m->covariance -= ramp_var * reach_s;
    m->yaw_var += ramp_var * reach_s * reach_s;
  }
}

/* Computes the output. The covariance is weighted by the probability minus GD_TAIL. */
static inline void gd_rl_collapse(gd_restlevel *s) {
  gd_rl_moments *m = &s->moments;
  gd_real total = GD_R(0.0);
  uint8_t k;
  gd_rl_collapse_means(s);
  m->yaw_var = m->covariance = m->bias_var = GD_R(0.0);
  for (k = 0; k < s->stored; ++k) {
    const gd_real weight = s->hypotheses[k].weight - GD_TAIL;
    if (weight > GD_R(0.0)) {
      total += weight;
      gd_rl_add_moments(s, m, &s->hypotheses[k], weight);
    }
  }
  m->yaw_var /= total;
  m->covariance /= total;
  m->bias_var /= total;
  s->bias_sigma_dps = GD_SQRT(gd_max(GD_R(0.0), m->bias_var));
}

#endif
