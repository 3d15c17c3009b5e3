/* The attitude filter of gyrodrift.h for tests. */
#include "gyrodrift.h"
#include "restlevel_params.h"

#define STATE gd_attitude
#define INPUTS 9 /* rates, accelerations, rest, temperature, and a command after the sample: 1 zero, 2 gap, 3 restarted, 10000 + heading,
                    or -10000 + turn rate. REMEMBERED: the parameters are biases, sigmas and age */
#define OUTPUTS 30
#define WORK gd_attitude_work

#ifdef REMEMBERED
static int begin(gd_attitude *a, const double *params) {
  gd_real biases[3], sigmas[3];
  for (int i = 0; i < 3; i++) {
    biases[i] = (gd_real)params[i];
    sigmas[i] = (gd_real)params[3 + i];
  }
  gd_attitude_init(a, NULL);
  return gd_attitude_remember(a, biases, sigmas, (gd_real)params[6]);
}
#else
static int begin(gd_attitude *a, const double *params) {
  gd_restlevel_params p;
  return gd_attitude_init(a, restlevel_params(&p, params));
}
#endif

static void copy(gd_real out[6], const double *input) {
  for (int i = 0; i < 6; i++) {
    out[i] = (gd_real)input[i];
  }
}

static void command(gd_attitude *a, const double *input) {
  if (input[8] == 1.0) {
    gd_attitude_zero(a);
  } else if (input[8] == 2.0) {
    gd_attitude_gap(a);
  } else if (input[8] == 3.0) {
    gd_attitude_restarted(a);
  } else if (input[8] >= 1000.0) {
    gd_attitude_heading(a, (gd_real)(input[8] - 10000.0), (gd_real)2.0, (gd_real)360.0);
  } else if (input[8] <= -1000.0) {
    gd_attitude_turn_rate(a, (gd_real)(input[8] + 10000.0), (gd_real)0.5);
  }
}

static int take(gd_attitude *a, double t_s, const double *input) {
  gd_real sample[6];
  copy(sample, input);
  const int taken = gd_attitude_update_with(a, t_s, sample, sample + 3, (gd_real)input[6], (gd_real)input[7]);
  command(a, input);
  return taken;
}

static int take_us(gd_attitude *a, uint32_t t_us, const double *input) {
  gd_real sample[6];
  copy(sample, input);
  const int taken = gd_attitude_update_us_with(a, t_us, sample, sample + 3, (gd_real)input[6], (gd_real)input[7]);
  command(a, input);
  return taken;
}

static void tell(const gd_attitude *a, double *output) {
  output[0] = 360.0 * (double)a->turns + (double)a->heading_deg;
  output[1] = (double)a->yaw_sigma_deg;
  output[2] = (double)a->bias_dps;
  output[3] = (double)a->bias_sigma_dps;
  output[4] = (double)a->tilt_deg;
  output[5] = (double)a->tilt_sigma_deg;
  output[6] = (double)a->rest_probability;
  output[7] = (double)a->confidence;
  output[8] = (double)a->heading_rate_dps;
  for (int i = 0; i < 3; i++) {
    output[9 + i] = (double)a->bias_xyz_dps[i];
  }
  for (int i = 0; i < 4; i++) {
    output[12 + i] = (double)a->q[i];
  }
  output[16] = (double)a->sum.count;
  output[17] = (double)a->samples;
  output[18] = (double)a->rejected;
  output[19] = (double)a->witness.refuted;
  output[20] = (double)a->yaw_deg;
  output[21] = (double)a->correction_deg;
  output[22] = (double)a->corrections;
  output[23] = (double)a->has_restarted;
  for (int i = 0; i < 3; i++) {
    output[24 + i] = (double)a->bias_sigma_xyz_dps[i];
    output[27 + i] = (double)a->line[i].slope_dps_c;
  }
}

#include "filter_driver.h"
