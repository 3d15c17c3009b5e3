/* Random samples and parameters for the attitude filter of gyrodrift.h, to run under sanitizers.

   fuzz_attitude FIRST COUNT    runs with the seeds FIRST to FIRST + COUNT - 1

   It ends with status 1 and the seed where an output is not finite, a sigma is negative, q is no rotation, probabilities
   do not add up to 1, a variance is negative beyond rounding, or a refused sample changes the state.
*/
#include "gyrodrift.h"
#include "random_numbers.h"
#include <stdio.h>
#include <stdlib.h>

#define PERIODS 24 /* of a run; a period repeats one kind of sample */

static double any_of(const double *values, unsigned count) { return values[next_random() % count]; }

static double any_rate(void) {
  static const double odd[] = {0.0, 2000.0, -9999.0, 1e5, 1e30, (double)NAN, HUGE_VAL};
  return one_in(12) ? any_of(odd, 7) : one_in(2) ? uniform(-0.5, 0.5) : uniform(-300.0, 300.0);
}

static double any_force(void) {
  static const double odd[] = {0.0, 9.81, 19.6, -157.0, 3900.0, 1e30, (double)NAN, -HUGE_VAL};
  return one_in(4) ? any_of(odd, 8) : uniform(-20.0, 20.0);
}

static double any_step(void) {
  static const double odd[] = {0.0, -0.1, 1e-6, 1e-3, 5.0, 1e5, 1e9};
  return one_in(6) ? any_of(odd, 7) : uniform(1e-3, 0.05);
}

static void fail(const char *what, unsigned long seed) {
  printf("%s, seed %lu\n", what, seed);
  exit(1);
}

static gd_real largest; /* variance of the run */

static int is_finite(gd_real x) { return x - x >= GD_R(0.0); }

static void check(const gd_attitude *a, unsigned long seed) {
  gd_real total = GD_R(0.0), size = GD_R(0.0);
  for (int i = 0; i < 4; i++) {
    size += a->q[i] * a->q[i];
  }
  if (!is_finite(a->yaw_deg) || !is_finite(a->bias_dps) || !is_finite(a->tilt_deg) || !is_finite(a->heading_rate_dps)) {
    fail("an output is not finite", seed);
  }
  if (!(GD_ABS(size - GD_R(1.0)) < GD_R(1e-3))) {
    fail("q is no rotation", seed);
  }
  if (!(is_finite(a->yaw_sigma_deg) && is_finite(a->tilt_sigma_deg) && is_finite(a->bias_sigma_dps)) ||
      a->yaw_sigma_deg < GD_R(0.0)) {
    fail("a sigma is not finite", seed);
  }
  for (int i = 0; i < a->sum.count; i++) {
    const gd_attitude_hypothesis *h = &a->sum.slot[a->sum.order[i]];
    total += h->weight;
    for (int k = 0; k < GD_ATTITUDE_STATES; k++) {
      largest = gd_max(largest, h->cov[gd_place(k, k)]);
      if (!(h->cov[gd_place(k, k)] >= GD_R(-1e-4) * largest)) {
        fail("a variance is negative", seed);
      }
    }
  }
  if (a->samples > 0 && !(GD_ABS(total - GD_R(1.0)) < GD_R(1e-4))) {
    fail("probabilities do not add up to 1", seed);
  }
  if (!(a->rest_probability > GD_R(-1e-4) && a->rest_probability < GD_R(1.0001) && a->confidence < GD_R(1.0001))) {
    fail("a probability is out of its range", seed);
  }
}

static gd_restlevel_params any_params(void) {
  gd_restlevel_params p = GD_RESTLEVEL_DEFAULTS;
  static const double windows[] = {0.01, 0.05, 0.3, 3.0, 60.0}, turn_on[] = {0.0, 0.001, 0.5, 5.0, 1000.0};
  static const double shares[] = {0.0, 0.2, 0.99}, walks[] = {0.0, 0.0005, 1.0, 10.0}, quiet[] = {0.01, 5.0, 100.0};
  p.window_s = (gd_real)any_of(windows, 5);
  p.turn_on_dps = (gd_real)any_of(turn_on, 5);
  p.still_start = (gd_real)any_of(shares, 3);
  p.rest_share = (gd_real)any_of(shares, 3);
  p.walk_dps_rts = (gd_real)any_of(walks, 4);
  p.quiet = (gd_real)any_of(quiet, 3);
  return p;
}

static void one_sample(gd_attitude *a, double t_s, const gd_real gyro[3], const gd_real accel[3], gd_real still,
                       gd_real temp_c) {
  static gd_attitude before;
  before = *a;
  if (!gd_attitude_update_with(a, t_s, gyro, accel, still, temp_c)) {
    before.rejected++;
    if (memcmp(&before, a, sizeof before) != 0) {
      fail("a refused sample changes the state", a->samples);
    }
  }
}

static void run(unsigned long seed) {
  static gd_attitude a;
  const gd_restlevel_params params = any_params();
  double t_s = uniform(-10.0, 1e6);
  largest = GD_R(0.0);
  gd_attitude_init(&a, one_in(2) ? &params : NULL);
  if (one_in(2)) {
    const gd_real biases[3] = {(gd_real)any_rate(), (gd_real)any_rate(), (gd_real)any_rate()};
    const gd_real sigmas[3] = {(gd_real)uniform(0.0, 1.0), (gd_real)uniform(-0.1, 1.0), (gd_real)uniform(0.0, 100.0)};
    gd_attitude_remember(&a, biases, sigmas, (gd_real)any_step());
  }
  for (int period = 0; period < PERIODS; period++) {
    const double step_s = any_step(), noise = one_in(3) ? 0.0 : 0.05;
    const int samples = (int)uniform(1.0, 300.0), is_level = one_in(2);
    const gd_real still = one_in(2) ? (gd_real)NAN : (gd_real)one_in(2);
    const double temp_c = one_in(2) ? uniform(-50.0, 100.0) : any_rate();
    double rates[3], forces[3];
    for (int i = 0; i < 3; i++) {
      rates[i] = any_rate();
      forces[i] = is_level ? (i == 2 ? 9.81 : 0.0) : any_force();
    }
    for (int k = 0; k < samples; k++) {
      gd_real gyro[3], accel[3];
      for (int i = 0; i < 3; i++) {
        gyro[i] = (gd_real)(rates[i] + uniform(-noise, noise));
        accel[i] = (gd_real)(forces[i] + uniform(-noise, noise));
      }
      t_s += step_s;
      one_sample(&a, t_s, gyro, accel, still, (gd_real)(temp_c + uniform(-0.1, 0.1)));
      check(&a, seed);
    }
    if (one_in(8)) {
      gd_attitude_zero(&a);
    }
  }
}

int main(int count, char **words) {
  const unsigned long first = count > 1 ? strtoul(words[1], NULL, 10) : 0;
  const unsigned long runs = count > 2 ? strtoul(words[2], NULL, 10) : 100;
  for (unsigned long seed = first; seed < first + runs; seed++) {
    state = 88172645463325252ULL + seed * 2862933555777941757ULL;
    for (int i = 0; i < 8; i++) {
      next_random();
    }
    run(seed);
  }
  return 0;
}
