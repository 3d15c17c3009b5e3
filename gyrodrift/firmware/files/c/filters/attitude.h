/* Attitude and heading from three gyro axes and an accelerometer, and how sure they are.

   The same filter as gyrodrift/filters/attitude: a Gaussian sum of error-state Kalman filters. docs/attitude.md has the
   equations. Of doubles, it gives the same yaw within 1e-9 deg.
*/
#ifndef GD_ATTITUDE_H
#define GD_ATTITUDE_H

#include "attitude_samples.h"

/* Longest time between two samples as a number of the filter, s: its turn is unknown long before. */
#define GD_ATTITUDE_LONGEST_GAP_S 1e6

/* Begin; 0 if a parameter was out of bounds: the defaults stand in its place. NULL: all defaults. */
static inline int gd_attitude_init(gd_attitude *a, const gd_restlevel_params *params) {
  const gd_restlevel_params defaults = GD_RESTLEVEL_DEFAULTS;
  const int is_valid = params == 0 || gd_restlevel_params_are_valid(params);
  int i;
  memset(a, 0, sizeof *a);
  a->c = gd_attitude_coefficients_of(params != 0 && is_valid ? params : &defaults);
  a->q[0] = 1;
  a->confidence = 1;
  a->tilt_sigma_deg = 180;
  a->accel_t_s = -1e30;
  a->accel_mps2[0] = a->accel_mps2[1] = a->accel_mps2[2] = (gd_real)NAN;
  a->witness.is_believed = 1;
  a->longest_step_s = GD_FIRST_STEP_S;
  a->motion.mean_force[2] = GD_ATTITUDE_GRAVITY;
  a->temp_c = GD_UNKNOWN_C;
  for (i = 0; i < 3; i++) {
    gd_begin_line(&a->line[i]);
  }
  return is_valid;
}

/* Whether a sample is taken; else it is counted. `dt_s` is the step from the sample before; after a restart the clock
   may have restarted too. */
static inline int gd_attitude_accepts(gd_attitude *a, double t_s, double *dt_s, const gd_real gyro[3]) {
  const int is_usable = t_s - t_s >= 0.0 && gd_are_below(gyro, GD_ATTITUDE_FASTEST_DPS);
  if (is_usable && a->longest_step_s < GD_TOLD_GAP && !(*dt_s > 0.0)) {
    *dt_s = GD_LEAST_STEP_S;
    a->accel_t_s = t_s;
  }
  if (is_usable && (a->samples == 0 || *dt_s > 0.0)) {
    return 1;
  }
  gd_count(&a->rejected);
  return 0;
}

/* Takes a sample: device time in s, rates in deg/s, specific force in m/s^2 (NaN: missing). `still` is 1 at rest and 0
   in motion by an external sensor; `temp_c` is the temperature of the sensor. Both are NaN if unknown.

   Returns 0 if the sample is refused: time stands still or goes back, or time or a rate is not finite or out of range.
*/
static inline int gd_attitude_update_with(gd_attitude *a, double t_s, const gd_real gyro_dps[3],
                                          const gd_real accel_mps2[3], gd_real still, gd_real temp_c) {
  double dt_s = t_s - a->t_s;
  if (!gd_attitude_accepts(a, t_s, &dt_s, gyro_dps)) {
    return 0;
  }
  gd_attitude_take(a, t_s, dt_s < GD_ATTITUDE_LONGEST_GAP_S ? dt_s : GD_ATTITUDE_LONGEST_GAP_S, gyro_dps, accel_mps2,
                   still, temp_c);
  return 1;
}

/* Takes a sample without a rest sensor and a temperature. */
static inline int gd_attitude_update(gd_attitude *a, double t_s, const gd_real gyro_dps[3],
                                     const gd_real accel_mps2[3]) {
  return gd_attitude_update_with(a, t_s, gyro_dps, accel_mps2, (gd_real)NAN, (gd_real)NAN);
}

/* The same by a clock of microseconds that wraps, as micros() of Arduino. Use one of the clocks. */
static inline int gd_attitude_update_us_with(gd_attitude *a, uint32_t t_us, const gd_real gyro_dps[3],
                                             const gd_real accel_mps2[3], gd_real still, gd_real temp_c) {
  const double step_s = a->samples > 0 ? gd_step_of_us(t_us, a->t_us, &a->suspect_us) : 0.0;
  const int waits = step_s < 0.0 && !(a->longest_step_s < GD_TOLD_GAP);
  double dt_s = waits ? GD_LEAST_STEP_S : step_s;
  if (!gd_attitude_accepts(a, 0.0, &dt_s, gyro_dps)) {
    return 0;
  }
  if (waits) {
    gd_count(&a->samples);
    a->correction_deg = 0;
    return 1;
  }
  a->t_us = a->suspect_us = t_us;
  gd_attitude_take(a, a->t_s + dt_s, dt_s, gyro_dps, accel_mps2, still, temp_c);
  return 1;
}

static inline int gd_attitude_update_us(gd_attitude *a, uint32_t t_us, const gd_real gyro_dps[3],
                                        const gd_real accel_mps2[3]) {
  return gd_attitude_update_us_with(a, t_us, gyro_dps, accel_mps2, (gd_real)NAN, (gd_real)NAN);
}

/* Begins with the biases of an earlier run, kept in EEPROM or flash: bias_xyz_dps, bias_sigma_xyz_dps, and their age in
   s. Call it after init, before the first sample. Where the age is unknown, a day is a good guess.

   Returns 0 if a value is not finite or out of its limits, or if there was a sample. */
static inline int gd_attitude_remember(gd_attitude *a, const gd_real bias_xyz_dps[3],
                                       const gd_real bias_sigma_xyz_dps[3], gd_real age_s) {
  const gd_real unit = GD_ATTITUDE_RAD * GD_ATTITUDE_RAD, spread = GD_ATTITUDE_SPREAD_OF_BIAS;
  const gd_real turn_on_var = a->c.bias_sigma * a->c.bias_sigma / (spread * spread * unit);
  const gd_real walk_var = a->c.walk_var / (GD_ATTITUDE_BIAS_WALK * GD_ATTITUDE_BIAS_WALK * unit);
  int k;
  for (k = 0; k < 3; k++) {
    if (!gd_is_memory(bias_xyz_dps[k], bias_sigma_xyz_dps[k], age_s, GD_R(GD_MOST_S)) || a->samples > 0) {
      return 0;
    }
  }
  for (k = 0; k < 3; k++) {
    a->remembered.bias_dps[k] = bias_xyz_dps[k];
    a->remembered.bias_var[k] = gd_remembered_var(bias_sigma_xyz_dps[k], age_s, walk_var, turn_on_var);
  }
  a->remembered.weight = gd_remembered_weight(bias_xyz_dps, bias_sigma_xyz_dps, 3, age_s, turn_on_var);
  return 1;
}

/* Takes a heading of another sensor at the end of the block, deg, in the frame of `yaw_deg`. `period_deg` is 360, or 90
   for one of the directions of a building. Give one a second at most: more do not count as independent. Returns 0 if it
   is no number. */
static inline int gd_attitude_heading(gd_attitude *a, gd_real heading_deg, gd_real sigma_deg, gd_real period_deg) {
  gd_attitude_catch_up(a);
  return period_deg > GD_R(0.0) && gd_aid_set(&a->aid, heading_deg - a->yaw_deg, sigma_deg, period_deg);
}

/* Takes a turn rate about the vertical of another sensor at the last sample, deg/s, as wheels that go straight. */
static inline int gd_attitude_turn_rate(gd_attitude *a, gd_real turn_dps, gd_real sigma_dps) {
  gd_attitude_catch_up(a);
  return gd_aid_set(&a->aid, a->heading_rate_dps - turn_dps, sigma_dps, GD_R(0.0));
}

/* Does a portion of the work at the end of a block; returns whether more is left. Call it between samples, as often as
   there is time: then updates only sum up, and the estimates follow some samples later. Samples wait meanwhile; the
   output turns by them and the last estimates. Without any call an update does all the work, at the last sample of a
   block. The results are the same bits in each case. */
static inline int gd_attitude_work(gd_attitude *a) {
  a->job.is_divided = 1;
  if (a->job.stage != GD_ATTITUDE_IDLE || a->job.queued > 0) {
    gd_attitude_do_next(a);
  }
  return a->job.stage != GD_ATTITUDE_IDLE || a->job.queued > 0;
}

#endif
