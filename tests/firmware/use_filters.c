/* Calls every public function of gyrodrift.h; valid C11 and C++11. */
#include "gyrodrift.h"

gd_real use_hdr(gd_hdr *h, double t_s, uint32_t t_us, gd_real rate_dps);

gd_real use_hdr(gd_hdr *h, double t_s, uint32_t t_us, gd_real rate_dps) {
  gd_hdr_params params = GD_HDR_DEFAULTS;
  params.tau_s = rate_dps;
  return gd_hdr_init(h, &params) && gd_hdr_update(h, t_s, rate_dps) && gd_hdr_update_us(h, t_us, rate_dps)
             ? h->yaw_deg
             : h->bias_dps;
}

gd_real use_restlevel(gd_restlevel *r, double t_s, uint32_t t_us, gd_real rate_dps);

gd_real use_restlevel(gd_restlevel *r, double t_s, uint32_t t_us, gd_real rate_dps) {
  gd_restlevel_params params = GD_RESTLEVEL_DEFAULTS;
  params.window_s = rate_dps;
  if (!gd_restlevel_init(r, &params)) {
    return params.window_s;
  }
#if GD_RESTLEVEL_MEMORY
  gd_restlevel_remember(r, rate_dps, rate_dps, rate_dps);
#endif
#if GD_RESTLEVEL_AUXILIARY
  gd_restlevel_update_with(r, t_s, rate_dps, rate_dps, rate_dps);
  gd_restlevel_update_us_with(r, t_us, rate_dps, rate_dps, rate_dps);
#endif
#if GD_RESTLEVEL_GAPS
  gd_restlevel_gap(r);
  gd_restlevel_restarted(r);
#endif
#if GD_RESTLEVEL_WORK
  gd_restlevel_work(r);
#endif
  if (gd_restlevel_update(r, t_s, rate_dps) && gd_restlevel_update_us(r, t_us, rate_dps)) {
    gd_restlevel_zero(r);
  }
  return r->yaw_deg + r->yaw_sigma_deg + r->bias_dps;
}

gd_real use_attitude(gd_attitude *a, double t_s, uint32_t t_us, const gd_real gyro_dps[3], const gd_real accel_mps2[3]);

gd_real use_attitude(gd_attitude *a, double t_s, uint32_t t_us, const gd_real gyro_dps[3], const gd_real accel_mps2[3]) {
  if (gd_attitude_init(a, NULL) && gd_attitude_remember(a, gyro_dps, gyro_dps, gyro_dps[0]) &&
      gd_attitude_update_with(a, t_s, gyro_dps, accel_mps2, gyro_dps[0], gyro_dps[0]) && gd_attitude_update(a, t_s, gyro_dps, accel_mps2) &&
      gd_attitude_update_us(a, t_us, gyro_dps, accel_mps2)) {
    gd_attitude_work(a);
    gd_attitude_gap(a);
    gd_attitude_restarted(a);
    gd_attitude_zero(a);
  }
  return a->yaw_deg + a->yaw_sigma_deg + a->bias_dps + gd_roll_deg(a->q) + gd_pitch_deg(a->q) + a->bias_xyz_dps[0] + a->tilt_deg + a->tilt_sigma_deg;
}
