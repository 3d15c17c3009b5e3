/* Restlevel: measurements of yaw and of the bias by a second sensor. Twin of restlevel/aided.py. */
#ifndef GD_RESTLEVEL_AIDED_H
#define GD_RESTLEVEL_AIDED_H

#include "aid.h"
#include "restlevel_collapse.h"
#include "restlevel_output.h"

#if GD_RESTLEVEL_AIDS

#define GD_KNOWN_SHARE GD_R(0.01) /* variance of a bias that a measurement has made known, as a share of the prior */

/* Update if the measurement is right; returns the density of the innovation. */
static inline gd_real gd_rl_aid_step(gd_rl_kalman *k, const gd_rl_hypothesis *h, const gd_aid *aid,
                                     gd_real innovation) {
  const int is_heading = aid->period_deg > GD_R(0.0);
  const gd_real with_bias = is_heading ? h->covariance : h->bias_var;
  const gd_real with_yaw = is_heading ? h->yaw_var : h->covariance;
  const gd_real variance = (is_heading ? with_yaw : with_bias) + aid->variance;
  const gd_real bias_gain = with_bias / variance, yaw_gain = with_yaw / variance;
  k->bias_dps = bias_gain * innovation;
  k->yaw_deg = yaw_gain * innovation;
  k->bias_var = gd_max(GD_R(0.0), h->bias_var - bias_gain * with_bias);
  k->covariance = h->covariance - bias_gain * with_yaw;
  k->yaw_var = gd_max(GD_R(0.0), h->yaw_var - yaw_gain * with_yaw);
  return gd_normal_pdf(innovation, variance);
}

/* Updates a hypothesis and its weight: the measurement is right or wrong. */
static inline void gd_rl_aid_update(const gd_rl_coefficients *c, gd_rl_hypothesis *h, const gd_aid *aid,
                                    gd_real expected_deg) {
  const gd_real expected = aid->period_deg > GD_R(0.0) ? h->yaw_deg - expected_deg : h->bias_dps;
  const gd_real innovation = gd_aid_wrap(aid, aid->value - expected), before_deg = h->yaw_deg;
  gd_rl_kalman none = {GD_R(0.0), GD_R(0.0), GD_R(0.0), GD_R(0.0), GD_R(0.0)}, right;
  const gd_real density = gd_rl_aid_step(&right, h, aid, innovation);
  const gd_real likelihood = (GD_R(1.0) - GD_WRONG_SHARE) * density + gd_aid_wrong_density(aid);
  const gd_real share = (GD_R(1.0) - GD_WRONG_SHARE) * density / likelihood;
  none.bias_var = h->bias_var;
  none.covariance = h->covariance;
  none.yaw_var = h->yaw_var;
  gd_rl_mix(h, &none, &right, share);
  h->checkpoint.yaw_deg += h->yaw_deg - before_deg;
  h->checkpoint.yaw_var = h->yaw_var;
  h->checkpoint.covariance = h->covariance;
  if (share > GD_MAJORITY) {
    h->moving_s = h->checkpoint.moving_s = GD_R(0.0);
    if (h->bias_var < GD_KNOWN_SHARE * c->turn_on_var) {
      h->knows_bias = 1;
    }
  }
  h->weight *= likelihood;
}

/* Keeps the yaw error of the scale factor so far in yaw. */
static inline void gd_rl_settle_scale(gd_restlevel *s) {
  const gd_real added_var = gd_rl_scale_var(s, s->moments.yaw_deg);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].yaw_var += added_var;
    s->hypotheses[k].checkpoint.yaw_var += added_var;
  }
  s->start_yaw_deg = s->moments.yaw_deg;
  s->travelled_deg = GD_R(0.0);
}

/* Takes the measurement that waits, at the end of a block; `expected_deg` is yaw by the estimates before it. */
static inline void gd_rl_take_aid(gd_restlevel *s, gd_real expected_deg) {
  uint8_t k;
  if (!(s->aid.variance > GD_R(0.0))) {
    return;
  }
  gd_rl_settle_scale(s);
  for (k = 0; k < s->stored; ++k) {
    gd_rl_aid_update(&s->c, &s->hypotheses[k], &s->aid, expected_deg);
  }
  gd_rl_normalise(s);
  gd_rl_collapse(s);
  s->start_yaw_deg = s->moments.yaw_deg;
  s->aid.variance = GD_R(0.0);
}

#endif

#endif
