/* Calibration of a gyro, as gyrodrift/values/calibration.py applies it: bias over temperature, scale, sign, axes,
   mount.

   gyrodrift writes a gd_calibration into my_gyro.h. Correct each measurement with it before the filter.
*/
#ifndef GD_CALIBRATION_H
#define GD_CALIBRATION_H

#include "real.h"

typedef struct {
  gd_real sign;                    /* -1: the device counts clockwise turns as positive */
  gd_real scale_ccw, scale_cw;     /* true rate over measured rate, by direction */
  gd_real bias_dps;                /* measured rate at rest at temp_c */
  gd_real bias_dps_per_c, temp_c;  /* slope of the bias; 0 without a temperature run */
  gd_real temp_low_c, temp_high_c; /* range of the run; beyond it the bias of the nearer end applies */
  gd_real gyro_bias_xy_dps[2];     /* measured rates about x and y at rest */
  gd_real gyro_matrix[3][3];       /* rates along the accelerometer from measured rates without bias */
  gd_real accel_offset_mps2[3];    /* measured acceleration without any force */
  gd_real accel_scale[3];          /* true over measured acceleration without offset */
  gd_real mount[3][3];             /* forward, left and up of the device, in the frame of the sensor */
} gd_calibration;

/* Changes nothing. */
#define GD_UNIT_MATRIX \
  {{GD_R(1.0), GD_R(0.0), GD_R(0.0)}, {GD_R(0.0), GD_R(1.0), GD_R(0.0)}, {GD_R(0.0), GD_R(0.0), GD_R(1.0)}}
#define GD_NO_CALIBRATION \
  {GD_R(1.0), GD_R(1.0), GD_R(1.0), GD_R(0.0), GD_R(0.0), GD_R(0.0), GD_R(-1000.0), GD_R(1000.0), \
   {GD_R(0.0), GD_R(0.0)}, GD_UNIT_MATRIX, {GD_R(0.0), GD_R(0.0), GD_R(0.0)}, {GD_R(1.0), GD_R(1.0), GD_R(1.0)}, \
   GD_UNIT_MATRIX}

/* Bias in deg/s at a temperature in C; NaN stands for an unknown temperature, which has the bias at temp_c. */
static inline gd_real gd_bias_at_dps(const gd_calibration *c, gd_real temp_c) {
  gd_real inside_c;
  if (!(c->bias_dps_per_c < GD_R(0.0) || c->bias_dps_per_c > GD_R(0.0)) || temp_c != temp_c) {
    return c->bias_dps;
  }
  inside_c = gd_min(gd_max(temp_c, c->temp_low_c), c->temp_high_c);
  return c->bias_dps + c->bias_dps_per_c * (inside_c - c->temp_c);
}

/* True rate of a measured rate without bias, deg/s. */
static inline gd_real gd_scaled_dps(const gd_calibration *c, gd_real rest_dps) {
  const gd_real signed_dps = c->sign * rest_dps;
  return signed_dps * (signed_dps >= GD_R(0.0) ? c->scale_ccw : c->scale_cw);
}

/* True rate of one axis, deg/s, for a measured rate and the temperature in C (NaN: unknown). */
static inline gd_real gd_calibrated_dps(const gd_calibration *c, gd_real rate_dps, gd_real temp_c) {
  return gd_scaled_dps(c, rate_dps - gd_bias_at_dps(c, temp_c));
}

static inline void gd_matrix_product(const gd_real m[3][3], gd_real v[3]) {
  const gd_real x = v[0], y = v[1], z = v[2];
  int row;
  for (row = 0; row < 3; row++) {
    v[row] = m[row][0] * x + m[row][1] * y + m[row][2] * z;
  }
}

/* Corrects the measured rates, deg/s, and accelerations, m/s^2, of three axes in place, and turns them into the frame
   of the device: x forward, y left, z up. */
static inline void gd_calibrate_axes(const gd_calibration *c, gd_real gyro_dps[3], gd_real accel_mps2[3],
                                     gd_real temp_c) {
  gd_real z_dps;
  int axis;
  gyro_dps[0] -= c->gyro_bias_xy_dps[0];
  gyro_dps[1] -= c->gyro_bias_xy_dps[1];
  gyro_dps[2] -= gd_bias_at_dps(c, temp_c);
  gd_matrix_product(c->gyro_matrix, gyro_dps);
  z_dps = gd_scaled_dps(c, gyro_dps[2]);
  for (axis = 0; axis < 3; axis++) {
    accel_mps2[axis] = (accel_mps2[axis] - c->accel_offset_mps2[axis]) * c->accel_scale[axis];
    if (axis > 0) { /* a device with sign -1 lies upside down: half a turn about x */
      gyro_dps[axis] *= c->sign;
      accel_mps2[axis] *= c->sign;
    }
  }
  gyro_dps[2] = z_dps;
  gd_matrix_product(c->mount, gyro_dps);
  gd_matrix_product(c->mount, accel_mps2);
}

#endif
