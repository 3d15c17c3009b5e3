/* Restlevel of gyrodrift.h for tests. */
#include "gyrodrift.h"
#include "restlevel_params.h"

#define STATE gd_restlevel
#define INPUTS 4 /* rate, rest, temperature, and a command after the sample: 1 zero, 2 gap, 3 restarted, 10000 + heading,
                    or -10000 + turn rate */
#define OUTPUTS 12
#define WORK gd_restlevel_work

static int begin(gd_restlevel *r, const double *params) {
  gd_restlevel_params p;
  return gd_restlevel_init(r, restlevel_params(&p, params));
}

static void command(gd_restlevel *r, const double *input) {
  if (input[3] == 1.0) {
    gd_restlevel_zero(r);
  } else if (input[3] == 2.0) {
    gd_restlevel_gap(r);
  } else if (input[3] == 3.0) {
    gd_restlevel_restarted(r);
  } else if (input[3] >= 1000.0) {
    gd_restlevel_heading(r, (gd_real)(input[3] - 10000.0), (gd_real)2.0, (gd_real)360.0);
  } else if (input[3] <= -1000.0) {
    gd_restlevel_turn_rate(r, (gd_real)(input[3] + 10000.0), (gd_real)0.5);
  }
}

static int take(gd_restlevel *r, double t_s, const double *input) {
  const int taken =
      gd_restlevel_update_with(r, t_s, (gd_real)input[0], (gd_real)input[1], (gd_real)input[2]);
  command(r, input);
  return taken;
}

static int take_us(gd_restlevel *r, uint32_t t_us, const double *input) {
  const int taken =
      gd_restlevel_update_us_with(r, t_us, (gd_real)input[0], (gd_real)input[1], (gd_real)input[2]);
  command(r, input);
  return taken;
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
  output[8] = (double)r->witness.refuted;
  output[9] = (double)r->line.slope_dps_c;
  output[10] = (double)r->correction_deg;
  output[11] = (double)r->corrections;
}

#include "filter_driver.h"
