/* The calibration of my_gyro.h over arrays: rates of one axis, and rates and accelerations of three. */
#include "my_gyro.h"

double calibrated_dps(double rate_dps, double temp_c);
void calibrate_axes(double axes[6], double temp_c);
void params(double hdr[5], double restlevel[8], double attitude[8]);

double calibrated_dps(double rate_dps, double temp_c) {
  return (double)gd_calibrated_dps(&MY_GYRO_CALIBRATION, (gd_real)rate_dps, (gd_real)temp_c);
}

void calibrate_axes(double axes[6], double temp_c) {
  gd_real gyro_dps[3], accel_mps2[3];
  int axis;
  for (axis = 0; axis < 3; axis++) {
    gyro_dps[axis] = (gd_real)axes[axis];
    accel_mps2[axis] = (gd_real)axes[axis + 3];
  }
  gd_calibrate_axes(&MY_GYRO_CALIBRATION, gyro_dps, accel_mps2, (gd_real)temp_c);
  for (axis = 0; axis < 3; axis++) {
    axes[axis] = (double)gyro_dps[axis];
    axes[axis + 3] = (double)accel_mps2[axis];
  }
}

void params(double hdr[5], double restlevel[8], double attitude[8]) {
  const gd_hdr_params *h = &MY_GYRO_HDR;
  const gd_restlevel_params *r = &MY_GYRO_RESTLEVEL, *a = &MY_GYRO_ATTITUDE;
  const gd_real *values[3];
  int i;
  values[0] = &h->i_c_dps;
  values[1] = &r->window_s;
  values[2] = &a->window_s;
  for (i = 0; i < 8; i++) {
    if (i < 5) {
      hdr[i] = (double)values[0][i];
    }
    restlevel[i] = (double)values[1][i];
    attitude[i] = (double)values[2][i];
  }
}
