/* Random samples and parameters for the filters of gyrodrift.h, to run under sanitizers.

   fuzz_filters FIRST COUNT     runs with the seeds FIRST to FIRST + COUNT - 1

   It ends with status 1 and the seed where an output is not finite, a sigma is negative, probabilities do not add up to
   1, or a refused sample changes the state.
*/
#include "gyrodrift.h"
#include "random_numbers.h"
#include <stdio.h>
#include <stdlib.h>

#define PERIODS 24 /* of a run; a period repeats one kind of sample */

static double any_size(double low, double high) { /* at the bounds, and of any size between */
  const double value = high * pow(10.0, -uniform(0.0, 12.0));
  return one_in(8) ? low : one_in(8) ? high : value < low ? low : value;
}

static double any_rate(void) {
  static const double odd[] = {0.0, -0.0, 250.0, -2000.0, 1e6, -1e9, 1e12, -1e12, 1.1e12, 1e-30, 0.061};
  const double infinite = HUGE_VAL;
  if (one_in(12)) {
    return one_in(2) ? infinite - infinite : infinite;
  }
  return one_in(3) ? odd[next_random() % (sizeof odd / sizeof *odd)] : uniform(-3.0, 3.0);
}

static double any_step(void) {
  static const double odd[] = {0.0, -0.1, 1e-13, 1e-12, 1e-6, 5.0, 1e5, 1e9};
  return one_in(10) ? odd[next_random() % (sizeof odd / sizeof *odd)] : uniform(1e-3, 0.05);
}

static void fail(const char *what, unsigned long seed) {
  printf("%s, seed %lu\n", what, seed);
  exit(1);
}

static int is_finite(gd_real x) { return x - x == GD_R(0.0); }

static void check_hdr(const gd_hdr *h, unsigned long seed) {
  if (!is_finite(h->yaw_deg) || !is_finite(h->bias_dps)) {
    fail("hdr: an output is not finite", seed);
  }
}

static void check_restlevel(const gd_restlevel *r, unsigned long seed) {
  gd_real total = GD_R(0.0);
  for (int k = 0; k < r->stored; k++) {
    total += r->hypotheses[k].weight;
  }
  if (!is_finite(r->yaw_deg) || !is_finite(r->bias_dps)) {
    fail("restlevel: yaw or bias is not finite", seed);
  }
  if (!is_finite(r->yaw_sigma_deg) || !is_finite(r->bias_sigma_dps) || r->yaw_sigma_deg < GD_R(0.0)) {
    fail("restlevel: a sigma is not finite", seed);
  }
  if (r->stored == 0 || r->stored > GD_RL_STORED || GD_ABS(total - GD_R(1.0)) > GD_R(1e-4)) {
    fail("restlevel: probabilities do not add up to 1", seed);
  }
  if (!(r->rest_probability > GD_R(-1e-4) && r->rest_probability < GD_R(1.0001) && r->confidence < GD_R(1.0001))) {
    fail("restlevel: a probability is out of its range", seed);
  }
}

static gd_restlevel_params any_params(void) {
  gd_restlevel_params p = GD_RESTLEVEL_DEFAULTS;
  if (one_in(2)) {
    p.window_s = (gd_real)any_size(1e-3, 60.0);
    p.quiet = (gd_real)any_size(1e-3, 100.0);
    p.turn_on_dps = (gd_real)any_size(0.0, 1000.0);
    p.walk_dps_rts = (gd_real)any_size(0.0, 10.0);
    p.drift_dps_s = (gd_real)any_size(0.0, 10.0);
    p.still_start = (gd_real)any_size(0.0, 0.9999);
    p.rest_share = (gd_real)any_size(0.0, 0.9999);
    p.scale_percent = (gd_real)any_size(0.0, 100.0);
  }
  return p;
}

static gd_hdr_params any_hdr_params(void) {
  gd_hdr_params p = GD_HDR_DEFAULTS;
  if (one_in(2)) {
    p.i_c_dps = (gd_real)any_size(0.0, 10.0);
    p.tau_s = (gd_real)any_size(0.0, 1000.0);
    p.theta_w_dps = (gd_real)any_size(1e-3, 2000.0);
    p.c1 = (gd_real)any_size(0.0, 1000.0);
    p.c2 = (gd_real)any_size(0.0, 10.0);
  }
  return p;
}

/* Takes a sample; a refused one may change the count alone. */
static void take(gd_hdr *h, gd_restlevel *r, double t_s, gd_real rate_dps, unsigned long seed) {
  gd_restlevel before = *r;
  const gd_real still = one_in(3) ? GD_R(1.0) : one_in(3) ? GD_R(0.0) : (gd_real)NAN;
  const gd_real temp_c = one_in(3) ? (gd_real)uniform(-120.0, 220.0) : (gd_real)NAN;
  const int is_taken = gd_hdr_update(h, t_s, rate_dps);
  if (gd_restlevel_update_with(r, t_s, rate_dps, still, temp_c) != is_taken) {
    fail("the filters disagree on a sample", seed);
  }
  before.rejected++;
  if (!is_taken && memcmp(&before, r, sizeof before) != 0) {
    fail("restlevel: a refused sample changes the state", seed);
  }
  if (one_in(500)) {
    gd_restlevel_zero(r);
  }
  check_hdr(h, seed);
  if (r->samples > 0) {
    check_restlevel(r, seed);
  }
}

static void run(unsigned long seed) {
  const gd_restlevel_params params = any_params();
  const gd_hdr_params hdr_params = any_hdr_params();
  gd_restlevel r;
  gd_hdr h;
  double t_s = one_in(4) ? uniform(-1e6, 1e6) : 0.0;
  memset(&r, 0xA5, sizeof r);
  memset(&h, 0xA5, sizeof h);
  gd_restlevel_init(&r, &params);
  gd_hdr_init(&h, &hdr_params);
#if GD_RESTLEVEL_MEMORY
  if (one_in(3)) {
    const gd_real sigma_dps = (gd_real)any_size(0.0, 10.0), age_s = (gd_real)any_size(0.0, 1e9);
    gd_restlevel_remember(&r, (gd_real)any_rate(), sigma_dps, age_s);
  }
#endif
  for (int k = 0; k < PERIODS; k++) {
    const double rate_dps = any_rate(), step_s = any_step(), noise_dps = one_in(2) ? 0.0 : uniform(0.0, 0.2);
    const int samples = (int)uniform(1.0, 150.0);
    for (int i = 0; i < samples; i++) {
      t_s += step_s;
      take(&h, &r, t_s, (gd_real)(rate_dps + uniform(-noise_dps, noise_dps)), seed);
    }
  }
}

int main(int argc, char **argv) {
  const unsigned long first = argc > 1 ? strtoul(argv[1], NULL, 10) : 1;
  const unsigned long count = argc > 2 ? strtoul(argv[2], NULL, 10) : 100;
  for (unsigned long seed = first; seed < first + count; seed++) {
    state = seed * 11400714819323198485ULL + 1;
    run(seed);
  }
  printf("%lu runs\n", count);
  return 0;
}
