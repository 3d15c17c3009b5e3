/* The classes of gyrodrift.h beside the functions of C: prints 1 if all results are equal. */
#include <cmath>
#include <cstdio>

#include "my_gyro.h"

static double rate_dps(int i) { return 0.1 + 0.01 * (i % 7) + (i > 500 && i < 700 ? 20.0 : 0.0); }

int main() {
  gyrodrift::Hdr hdr, tuned(MY_GYRO_HDR);
  gd_hdr h, t;
  int is_equal = gd_hdr_init(&h, NULL) && gd_hdr_init(&t, &MY_GYRO_HDR);
  for (int i = 0; i < 1000; i++) {
    const gd_real rate = (gd_real)rate_dps(i);
    is_equal &= hdr.update(0.01 * i, rate) == (gd_hdr_update(&h, 0.01 * i, rate) != 0);
    is_equal &= tuned.update_us(10000u * (uint32_t)i, rate) == (gd_hdr_update_us(&t, 10000u * (uint32_t)i, rate) != 0);
    is_equal &= !hdr.update(0.01 * i, rate);
    gd_hdr_update(&h, 0.01 * i, rate);
  }
  gyrodrift::Restlevel restlevel, own(MY_GYRO_RESTLEVEL);
  gd_restlevel r, o;
  is_equal &= gd_restlevel_init(&r, NULL) && gd_restlevel_init(&o, &MY_GYRO_RESTLEVEL);
  for (int i = 0; i < 1000; i++) {
    const gd_real rate = (gd_real)rate_dps(i);
    while (restlevel.work()) {
    }
    is_equal &= restlevel.update(0.01 * i, rate) == (gd_restlevel_update(&r, 0.01 * i, rate) != 0);
    is_equal &= own.update_us(10000u * (uint32_t)i, rate) == (gd_restlevel_update_us(&o, 10000u * (uint32_t)i, rate) != 0);
  }
  while (restlevel.work()) {
  }
  is_equal &= !(restlevel.yaw_deg() < r.yaw_deg) && !(restlevel.yaw_deg() > r.yaw_deg);
  is_equal &= !(restlevel.yaw_sigma_deg() < r.yaw_sigma_deg) && !(restlevel.bias_dps() > r.bias_dps);
  is_equal &= !(own.yaw_deg() < o.yaw_deg) && !(own.yaw_deg() > o.yaw_deg) && own.state().samples == 1000;
  is_equal &= !(restlevel.bias_sigma_dps() < r.bias_sigma_dps) && !(restlevel.rest_probability() < r.rest_probability);
  is_equal &= restlevel.update(9.995, 0.1f, 1) && own.update_us(9995000u, 0.1f, 0, 21);
  is_equal &= !restlevel.state().witness.is_moving && own.state().witness.is_moving && own.state().temp_c > 20;
  restlevel.zero();
  restlevel.gap();
  own.restarted();
  is_equal &= restlevel.yaw_sigma_deg() == 0 && restlevel.state().longest_step_s == 0 && own.state().longest_step_s < 0;
  gyrodrift::Attitude attitude, space(MY_GYRO_ATTITUDE);
  gd_attitude a, b;
  is_equal &= gd_attitude_init(&a, NULL) && gd_attitude_init(&b, &MY_GYRO_ATTITUDE);
  for (int i = 0; i < 1000; i++) {
    const gd_real gyro_dps[3] = {0.02f, -0.01f, (gd_real)rate_dps(i)};
    const gd_real accel_mps2[3] = {0.1f, 0.02f * (gd_real)(i % 3), 9.8f};
    const uint32_t t_us = 10000u * (uint32_t)i;
    while (attitude.work()) {
    }
    is_equal &= attitude.update(0.01 * i, gyro_dps, accel_mps2) ==
                (gd_attitude_update(&a, 0.01 * i, gyro_dps, accel_mps2) != 0);
    is_equal &= space.update_us(t_us, gyro_dps, accel_mps2) ==
                (gd_attitude_update_us(&b, t_us, gyro_dps, accel_mps2) != 0);
  }
  while (attitude.work()) {
  }
  const double roll_deg = (double)attitude.roll_deg(), pitch_deg = (double)attitude.pitch_deg();
  is_equal &= std::fabs(std::hypot(roll_deg, pitch_deg) - (double)attitude.tilt_deg()) < 0.01 && pitch_deg < 0;
  is_equal &= !(attitude.bias_sigma_dps() < a.bias_sigma_dps) && !(attitude.tilt_sigma_deg() < a.tilt_sigma_deg);
  const gd_real still_gyro_dps[3] = {0.02f, -0.01f, 0.1f}, up_mps2[3] = {0.1f, 0.02f, 9.8f};
  is_equal &= attitude.update(9.995, still_gyro_dps, up_mps2, 1) && space.update_us(9995000u, still_gyro_dps, up_mps2, 1);
  is_equal &= gd_attitude_update_with(&a, 9.995, still_gyro_dps, up_mps2, 1, (gd_real)NAN) && a.block.still == 1;
  is_equal &= gd_attitude_update_us_with(&b, 9995000u, still_gyro_dps, up_mps2, 1, (gd_real)NAN);
  is_equal &= attitude.state().block.still == 1 && !(attitude.yaw_deg() < a.yaw_deg);
  attitude.gap();
  space.restarted();
  space.zero();
  is_equal &= attitude.state().longest_step_s == 0 && space.state().longest_step_s < 0 && space.yaw_sigma_deg() == 0;
  is_equal &= !(attitude.yaw_deg() < a.yaw_deg) && !(attitude.yaw_deg() > a.yaw_deg) && a.yaw_deg > 10;
  is_equal &= !(attitude.yaw_sigma_deg() < a.yaw_sigma_deg) && !(attitude.tilt_deg() < a.tilt_deg);
  is_equal &= !(space.bias_dps() < b.bias_dps) && !(space.bias_dps() > b.bias_dps) && space.state().samples == 1001;
  is_equal &= !(hdr.yaw_deg() < h.yaw_deg) && !(hdr.yaw_deg() > h.yaw_deg) && h.yaw_deg > 10;
  is_equal &= !(tuned.bias_dps() < t.bias_dps) && !(tuned.bias_dps() > t.bias_dps) && tuned.state().samples == 1000;
  std::printf("%d\n", is_equal);
  return 0;
}
