/* Restlevel: restart of the yaw sigma. Twin of restlevel/zero.py. */
#ifndef GD_RESTLEVEL_ZERO_H
#define GD_RESTLEVEL_ZERO_H

#include "restlevel.h"

/* Sets the yaw of a hypothesis to the output yaw within a block. A hypothesis of motion adds the whole block at its
   end, and one of rest nothing. */
static inline void gd_rl_zero_hypothesis(gd_rl_hypothesis *h, const gd_restlevel *s) {
  const gd_real gone_s = (gd_real)s->GD_RL_SUMS.seconds, now_deg = gd_rl_expected_deg(s);
  h->checkpoint.yaw_deg = now_deg;
  h->checkpoint.yaw_var = h->checkpoint.covariance = GD_R(0.0);
  if (h->is_at_rest) {
    h->yaw_deg = now_deg;
    h->yaw_var = h->covariance = GD_R(0.0);
    return;
  }
  h->yaw_deg = s->moments.yaw_deg + (h->bias_dps - s->bias_dps) * gone_s;
  h->covariance = h->bias_var * gone_s;
  h->yaw_var = h->covariance * gone_s;
}

/* Restarts the yaw sigma at the last sample: it counts the yaw turned since. `yaw_deg` stays. */
static inline void gd_restlevel_zero(gd_restlevel *s) {
  uint8_t k;
  if (s->samples == 0) {
    return;
  }
  gd_rl_catch_up(s);
  gd_rl_set_yaw(s);
  for (k = 0; k < s->stored; ++k) {
    gd_rl_zero_hypothesis(&s->hypotheses[k], s);
  }
  s->start_yaw_deg = GD_IS_FLOAT ? s->yaw_deg - s->base_deg : s->yaw_deg;
  s->travelled_deg = s->travelled_s = s->yaw_sigma_deg = GD_R(0.0);
  s->moments.covariance = s->moments.bias_var * (gd_real)s->GD_RL_SUMS.seconds;
  s->moments.yaw_var = s->moments.covariance * (gd_real)s->GD_RL_SUMS.seconds;
}

#endif
