/* Parameters of the filters, their defaults and their bounds. Written by gyrodrift/firmware/parameters.py. */
#ifndef GD_PARAMETERS_H
#define GD_PARAMETERS_H

#include "real.h"

typedef struct {
  gd_real i_c_dps; /* integrator step per sample, deg/s: large learns fast and oscillates */
  gd_real tau_s; /* time constant of the low-pass before the sign is taken, s */
  gd_real theta_w_dps; /* no learning above this rate, deg/s; a larger bias is never learned */
  gd_real c1; /* attenuation of repeated steps: 0 switches it off */
  gd_real c2; /* exponent of the attenuation */
} gd_hdr_params;

#define GD_HDR_DEFAULTS \
  {GD_R(0.0006), GD_R(0.9447), GD_R(0.5608), GD_R(0.7839), GD_R(1.2161)}

static inline int gd_hdr_params_are_valid(const gd_hdr_params *p) {
  return p->i_c_dps >= GD_R(0.0) && p->i_c_dps <= GD_R(10.0) &&
         p->tau_s >= GD_R(0.0) && p->tau_s <= GD_R(1000.0) &&
         p->theta_w_dps > GD_R(0.0) && p->theta_w_dps <= GD_R(2000.0) &&
         p->c1 >= GD_R(0.0) && p->c1 <= GD_R(1000.0) &&
         p->c2 >= GD_R(0.0) && p->c2 <= GD_R(10.0);
}

typedef struct {
  gd_real window_s; /* length of the blocks tested for rest, s */
  gd_real quiet; /* variance of a block above the noise up to which it is quiet, in standard errors */
  gd_real turn_on_dps; /* standard deviation of the bias at power-on, deg/s (0: the sensor subtracts it) */
  gd_real walk_dps_rts; /* random walk of the bias, deg/s/√s */
  gd_real drift_dps_s; /* fastest drift of the bias, deg/s² */
  gd_real still_start; /* probability of rest at the first sample */
  gd_real rest_share; /* probability that a later constant rate is a rest */
  gd_real scale_percent; /* standard deviation of the scale factor, %; changes only yaw_sigma_deg */
} gd_restlevel_params;

#define GD_RESTLEVEL_DEFAULTS \
  {GD_R(0.3), GD_R(5.0), GD_R(0.5), GD_R(0.0005), GD_R(0.004), GD_R(0.99), GD_R(0.2), GD_R(1.0)}

static inline int gd_restlevel_params_are_valid(const gd_restlevel_params *p) {
  return p->window_s > GD_R(0.0) && p->window_s <= GD_R(60.0) &&
         p->quiet > GD_R(0.0) && p->quiet <= GD_R(100.0) &&
         p->turn_on_dps >= GD_R(0.0) && p->turn_on_dps <= GD_R(1000.0) &&
         p->walk_dps_rts >= GD_R(0.0) && p->walk_dps_rts <= GD_R(10.0) &&
         p->drift_dps_s >= GD_R(0.0) && p->drift_dps_s <= GD_R(10.0) &&
         p->still_start >= GD_R(0.0) && p->still_start < GD_R(1.0) &&
         p->rest_share >= GD_R(0.0) && p->rest_share < GD_R(1.0) &&
         p->scale_percent >= GD_R(0.0) && p->scale_percent <= GD_R(100.0);
}

#endif
