/* The filters as classes of C++, without allocation; `state()` has all fields of the struct. */
#ifndef GD_WRAPPERS_H
#define GD_WRAPPERS_H

#include "hdr.h"
#include "restlevel.h"
#include "attitude.h"

#ifdef __cplusplus
namespace gyrodrift {

class Hdr {
public:
  Hdr() { gd_hdr_init(&state_, NULL); }
  explicit Hdr(const gd_hdr_params &params) { gd_hdr_init(&state_, &params); }
  bool update(double t_s, gd_real rate_dps) { return gd_hdr_update(&state_, t_s, rate_dps) != 0; }
  bool update_us(uint32_t t_us, gd_real rate_dps) { return gd_hdr_update_us(&state_, t_us, rate_dps) != 0; }
  gd_real yaw_deg() const { return state_.yaw_deg; }
  gd_real bias_dps() const { return state_.bias_dps; }
  gd_hdr &state() { return state_; }

private:
  gd_hdr state_;
};

class Restlevel {
public:
  Restlevel() { gd_restlevel_init(&state_, NULL); }
  explicit Restlevel(const gd_restlevel_params &params) { gd_restlevel_init(&state_, &params); }
  bool update(double t_s, gd_real rate_dps) { return gd_restlevel_update(&state_, t_s, rate_dps) != 0; }
  bool update_us(uint32_t t_us, gd_real rate_dps) { return gd_restlevel_update_us(&state_, t_us, rate_dps) != 0; }
  gd_real yaw_deg() const { return state_.yaw_deg; }
  gd_real yaw_sigma_deg() const { return state_.yaw_sigma_deg; }
  gd_real bias_dps() const { return state_.bias_dps; }
  gd_restlevel &state() { return state_; }

private:
  gd_restlevel state_;
};

class Attitude {
public:
  Attitude() { gd_attitude_init(&state_, NULL); }
  explicit Attitude(const gd_restlevel_params &params) { gd_attitude_init(&state_, &params); }
  bool update(double t_s, const gd_real gyro_dps[3], const gd_real accel_mps2[3]) {
    return gd_attitude_update(&state_, t_s, gyro_dps, accel_mps2) != 0;
  }
  bool update_us(uint32_t t_us, const gd_real gyro_dps[3], const gd_real accel_mps2[3]) {
    return gd_attitude_update_us(&state_, t_us, gyro_dps, accel_mps2) != 0;
  }
  gd_real yaw_deg() const { return state_.yaw_deg; }
  gd_real yaw_sigma_deg() const { return state_.yaw_sigma_deg; }
  gd_real bias_dps() const { return state_.bias_dps; }
  gd_real tilt_deg() const { return state_.tilt_deg; }
  gd_attitude &state() { return state_; }

private:
  gd_attitude state_;
};

} /* namespace gyrodrift */
#endif

#endif
