/* HDR of gyrodrift.h for tests. */
#include "gyrodrift.h"

#define STATE gd_hdr
#define INPUTS 1
#define OUTPUTS 7

static int begin(gd_hdr *h, const double *params) {
  gd_hdr_params p;
  if (params == NULL) {
    return gd_hdr_init(h, NULL);
  }
  p.i_c_dps = (gd_real)params[0];
  p.tau_s = (gd_real)params[1];
  p.theta_w_dps = (gd_real)params[2];
  p.c1 = (gd_real)params[3];
  p.c2 = (gd_real)params[4];
  return gd_hdr_init(h, &p);
}

static int take(gd_hdr *h, double t_s, const double *input) { return gd_hdr_update(h, t_s, (gd_real)input[0]); }

static int take_us(gd_hdr *h, uint32_t t_us, const double *input) {
  return gd_hdr_update_us(h, t_us, (gd_real)input[0]);
}

static void tell(const gd_hdr *h, double *output) {
  output[0] = (double)h->yaw_deg;
  output[1] = (double)h->bias_dps;
  output[2] = (double)h->lpf_dps;
  output[3] = (double)h->omega_dps;
  output[4] = (double)h->omega_d_dps;
  output[5] = (double)h->samples;
  output[6] = (double)h->rejected;
}

#include "filter_driver.h"
