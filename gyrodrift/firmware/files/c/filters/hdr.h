/* HDR, heuristic drift reduction (Borenstein and Ojeda 2009, DOI 10.1504/IJVICS.2009.027747).

   The same recursion as gyrodrift/filters/hdr.py. Of doubles, it gives the same bits. Of floats, the increments of the
   low-pass are summed instead of its values, which would lose small increments.
*/
#ifndef GD_HDR_H
#define GD_HDR_H

#include "real.h"
#include "parameters.h"

/* State. `yaw_deg` and `bias_dps` are the results; a copy of the struct saves the filter. */
typedef struct {
  gd_real yaw_deg;
  gd_real bias_dps; /* drift estimate, -I */
  uint32_t samples, rejected;
  union { /* time of the last sample, by the clock in use */
    double t_s;
    uint32_t t_us;
  };
  uint32_t suspect_us; /* see gd_step_of_us */
  gd_real lpf_dps, i_dps, omega_dps, omega_d_dps;
  gd_real yaw_lost_deg, lpf_lost_dps, i_lost_dps; /* what the sums have lost; 0 in double */
  uint32_t run;       /* number of equal signs in a row */
  int8_t sign_before; /* sign of omega one sample earlier than `omega_dps` */
  gd_hdr_params params;
} gd_hdr;

/* Begins. NULL stands for the defaults, which are also used if a parameter is out of its bounds: then it returns 0. */
static inline int gd_hdr_init(gd_hdr *h, const gd_hdr_params *params) {
  const gd_hdr_params defaults = GD_HDR_DEFAULTS;
  const int is_valid = params == NULL || gd_hdr_params_are_valid(params);
  memset(h, 0, sizeof *h);
  h->params = params != NULL && is_valid ? *params : defaults;
  h->run = 1;
  return is_valid;
}

/* Integrator step R(r)·i_c in deg/s for a run of r equal signs. */
static inline gd_real gd_hdr_attenuated_step(const gd_hdr_params *p, uint32_t run) {
  const gd_real steepness = GD_POW((gd_real)run, p->c2);
  if (p->c1 == GD_R(0.0)) {
    return p->i_c_dps; /* also where the power is beyond all floats */
  }
  return (GD_R(1.0) + p->c1) / (GD_R(1.0) + p->c1 * steepness) * p->i_c_dps;
}

/* Filters the rate; returns the increase of omega since the sample before. */
static inline gd_real gd_hdr_low_pass(gd_hdr *h, gd_real dt_s, gd_real rate_dps, gd_real drift_step_dps) {
  const gd_real tau_s = h->params.tau_s;
  if (!GD_IS_FLOAT) {
    const gd_real omega_before_dps = h->omega_dps;
    h->lpf_dps = (rate_dps * dt_s + tau_s * h->lpf_dps) / (dt_s + tau_s);
    h->omega_dps = h->lpf_dps + h->i_dps;
    return h->omega_dps - omega_before_dps;
  } else {
    const gd_real lpf_step_dps = (rate_dps - h->lpf_dps - h->lpf_lost_dps) * dt_s / (dt_s + tau_s);
    gd_add(&h->lpf_dps, &h->lpf_lost_dps, lpf_step_dps);
    h->omega_dps = h->lpf_dps + h->i_dps;
    return lpf_step_dps + drift_step_dps;
  }
}

static inline void gd_hdr_advance(gd_hdr *h, gd_real dt_s, gd_real rate_dps) {
  const gd_real omega_dps = h->omega_dps;
  const int8_t sign = (int8_t)((omega_dps > GD_R(0.0)) - (omega_dps < GD_R(0.0)));
  gd_real drift_step_dps = GD_R(0.0), increase_dps;
  if (h->samples < 2 || sign != h->sign_before) {
    h->run = 1;
  } else {
    gd_count(&h->run);
  }
  if (GD_ABS(omega_dps) < h->params.theta_w_dps && sign != 0) {
    drift_step_dps = -(gd_real)sign * gd_hdr_attenuated_step(&h->params, h->run);
    gd_add(&h->i_dps, &h->i_lost_dps, drift_step_dps);
  }
  increase_dps = gd_hdr_low_pass(h, dt_s, rate_dps, drift_step_dps);
  h->omega_d_dps = h->omega_dps + h->params.tau_s / dt_s * increase_dps;
  gd_add(&h->yaw_deg, &h->yaw_lost_deg, h->omega_d_dps * dt_s);
  h->bias_dps = GD_R(0.0) - h->i_dps;
  h->sign_before = sign;
  gd_count(&h->samples);
}

static inline void gd_hdr_first(gd_hdr *h, gd_real rate_dps) {
  h->lpf_dps = h->omega_dps = h->omega_d_dps = rate_dps;
  h->samples = 1;
}

/* Takes a sample: device time in s and rate in deg/s, counter-clockwise positive.

   Returns 0 if the sample is refused: time stands still or goes back, or a value is not finite or out of its limits.
*/
static inline int gd_hdr_update(gd_hdr *h, double t_s, gd_real rate_dps) {
  const double dt_s = t_s - h->t_s;
  if (!gd_is_within(t_s, rate_dps) || (h->samples > 0 && !(dt_s >= GD_LEAST_STEP_S))) {
    gd_count(&h->rejected);
    return 0;
  }
  if (h->samples == 0) {
    gd_hdr_first(h, rate_dps);
  } else {
    gd_hdr_advance(h, (gd_real)dt_s, rate_dps);
  }
  h->t_s = t_s;
  return 1;
}

/* The same by a clock of microseconds that wraps, as micros() of Arduino. Use one of the two functions. Yaw is held
   over a pause of more than 10 s. */
static inline int gd_hdr_update_us(gd_hdr *h, uint32_t t_us, gd_real rate_dps) {
  const double dt_s = gd_step_of_us(t_us, h->t_us, &h->suspect_us);
  const gd_real yaw_deg = h->yaw_deg;
  if (dt_s < 0.0 && h->samples > 0 && gd_is_within(0.0, rate_dps)) {
    gd_count(&h->samples);
    return 1;
  }
  if (!gd_is_within(0.0, rate_dps) || (h->samples > 0 && !(dt_s > 0.0))) {
    gd_count(&h->rejected);
    return 0;
  }
  if (h->samples == 0) {
    gd_hdr_first(h, rate_dps);
  } else {
    gd_hdr_advance(h, (gd_real)dt_s, rate_dps);
    h->yaw_deg = dt_s > GD_FAR_S ? yaw_deg : h->yaw_deg;
  }
  h->t_us = h->suspect_us = t_us;
  return 1;
}

#endif
