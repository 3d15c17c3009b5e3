/* Restlevel of gyrodrift.h, its rate alone, for tests. REMEMBERED: the parameters are bias, sigma and age. */
#include "gyrodrift.h"
#include "restlevel_params.h"

#define STATE gd_restlevel
#define INPUTS 1
#define OUTPUTS 8

#ifdef REMEMBERED
static int begin(gd_restlevel *r, const double *params) {
  gd_restlevel_init(r, NULL);
  return gd_restlevel_remember(r, (gd_real)params[0], (gd_real)params[1], (gd_real)params[2]);
}
#else
static int begin(gd_restlevel *r, const double *params) {
  gd_restlevel_params p;
  return gd_restlevel_init(r, restlevel_params(&p, params));
}
#endif

static int take(gd_restlevel *r, double t_s, const double *input) {
  return gd_restlevel_update(r, t_s, (gd_real)input[0]);
}

static int take_us(gd_restlevel *r, uint32_t t_us, const double *input) {
  return gd_restlevel_update_us(r, t_us, (gd_real)input[0]);
}

static void tell(const gd_restlevel *r, double *output) {
  output[0] = (double)r->yaw_deg;
  output[1] = (double)r->yaw_sigma_deg;
  output[2] = (double)r->bias_dps;
  output[3] = (double)r->bias_sigma_dps;
  output[4] = (double)r->rest_probability;
  output[5] = (double)r->confidence;
  output[6] = (double)r->samples;
  output[7] = (double)r->rejected;
}

#include "filter_driver.h"
