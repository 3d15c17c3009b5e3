/* The filters as classes of C++, without allocation; `state()` has all fields of the struct. */
#ifndef GD_WRAPPERS_H
#define GD_WRAPPERS_H

#include "attitude_zero.h"
#include "hdr.h"
#include "restlevel_with.h"
#include "restlevel_zero.h"

#ifdef __cplusplus
extern "C++" { /* also inside extern "C", which has no templates */
namespace gyrodrift {

/* GD_REAL and the sizes are parameters of the classes, so that files of a program may set them differently: the linker
   takes classes of one name for one class. */
template <size_t RealBytes>
class HdrOf {
public:
  HdrOf() { gd_hdr_init(&state_, NULL); }
  explicit HdrOf(const gd_hdr_params &params) { gd_hdr_init(&state_, &params); }
  bool update(double t_s, gd_real rate_dps) { return gd_hdr_update(&state_, t_s, rate_dps) != 0; }
  bool update_us(uint32_t t_us, gd_real rate_dps) { return gd_hdr_update_us(&state_, t_us, rate_dps) != 0; }
  bool work() { return false; } /* an update leaves none */
  gd_real yaw_deg() const { return state_.yaw_deg; }
  gd_real bias_dps() const { return state_.bias_dps; }
  gd_hdr &state() { return state_; }

private:
  gd_hdr state_;
};

template <size_t RealBytes, int Hypotheses, int Auxiliary, int Memory, int Gaps, int Work, int Aids>
class RestlevelOf {
public:
  RestlevelOf() { gd_restlevel_init(&state_, NULL); }
  explicit RestlevelOf(const gd_restlevel_params &params) { gd_restlevel_init(&state_, &params); }
  bool update(double t_s, gd_real rate_dps) { return gd_restlevel_update(&state_, t_s, rate_dps) != 0; }
  bool update_us(uint32_t t_us, gd_real rate_dps) { return gd_restlevel_update_us(&state_, t_us, rate_dps) != 0; }
#if GD_RESTLEVEL_AUXILIARY
  /* `still` is 1 at rest and 0 in motion by an external sensor; NaN if unknown. */
  bool update(double t_s, gd_real rate_dps, gd_real still, gd_real temp_c = (gd_real)NAN) {
    return gd_restlevel_update_with(&state_, t_s, rate_dps, still, temp_c) != 0;
  }
  bool update_us(uint32_t t_us, gd_real rate_dps, gd_real still, gd_real temp_c = (gd_real)NAN) {
    return gd_restlevel_update_us_with(&state_, t_us, rate_dps, still, temp_c) != 0;
  }
#endif
#if GD_RESTLEVEL_GAPS
  void gap() { gd_restlevel_gap(&state_); }
  void restarted() { gd_restlevel_restarted(&state_); }
#endif
#if GD_RESTLEVEL_AIDS
  bool heading(gd_real heading_deg, gd_real sigma_deg, gd_real period_deg = 360) {
    return gd_restlevel_heading(&state_, heading_deg, sigma_deg, period_deg) != 0;
  }
  bool turn_rate(gd_real turn_dps, gd_real sigma_dps) {
    return gd_restlevel_turn_rate(&state_, turn_dps, sigma_dps) != 0;
  }
#endif
#if GD_RESTLEVEL_WORK
  bool work() { return gd_restlevel_work(&state_) != 0; }
#endif
  void zero() { gd_restlevel_zero(&state_); }
  gd_real yaw_deg() const { return state_.yaw_deg; }
  gd_real yaw_sigma_deg() const { return state_.yaw_sigma_deg; }
  gd_real bias_dps() const { return state_.bias_dps; }
  gd_real bias_sigma_dps() const { return state_.bias_sigma_dps; }
  gd_real rest_probability() const { return state_.rest_probability; }
  gd_real correction_deg() const { return state_.correction_deg; }
  gd_restlevel &state() { return state_; }

private:
  gd_restlevel state_;
};

template <size_t RealBytes, int Hypotheses, int Queue>
class AttitudeOf {
public:
  AttitudeOf() { gd_attitude_init(&state_, NULL); }
  explicit AttitudeOf(const gd_restlevel_params &params) { gd_attitude_init(&state_, &params); }
  bool update(double t_s, const gd_real gyro_dps[3], const gd_real accel_mps2[3]) {
    return gd_attitude_update(&state_, t_s, gyro_dps, accel_mps2) != 0;
  }
  bool update_us(uint32_t t_us, const gd_real gyro_dps[3], const gd_real accel_mps2[3]) {
    return gd_attitude_update_us(&state_, t_us, gyro_dps, accel_mps2) != 0;
  }
  /* `still` is 1 at rest and 0 in motion by an external sensor; NaN if unknown, as the temperature. */
  bool update(double t_s, const gd_real gyro_dps[3], const gd_real accel_mps2[3], gd_real still,
              gd_real temp_c = (gd_real)NAN) {
    return gd_attitude_update_with(&state_, t_s, gyro_dps, accel_mps2, still, temp_c) != 0;
  }
  bool update_us(uint32_t t_us, const gd_real gyro_dps[3], const gd_real accel_mps2[3], gd_real still,
                 gd_real temp_c = (gd_real)NAN) {
    return gd_attitude_update_us_with(&state_, t_us, gyro_dps, accel_mps2, still, temp_c) != 0;
  }
  bool remember(const gd_real bias_xyz_dps[3], const gd_real bias_sigma_xyz_dps[3], gd_real age_s) {
    return gd_attitude_remember(&state_, bias_xyz_dps, bias_sigma_xyz_dps, age_s) != 0;
  }
  void gap() { gd_attitude_gap(&state_); }
  void restarted() { gd_attitude_restarted(&state_); }
  bool heading(gd_real heading_deg, gd_real sigma_deg, gd_real period_deg = 360) {
    return gd_attitude_heading(&state_, heading_deg, sigma_deg, period_deg) != 0;
  }
  bool turn_rate(gd_real turn_dps, gd_real sigma_dps) {
    return gd_attitude_turn_rate(&state_, turn_dps, sigma_dps) != 0;
  }
  bool work() { return gd_attitude_work(&state_) != 0; }
  void zero() { gd_attitude_zero(&state_); }
  gd_real yaw_deg() const { return state_.yaw_deg; }
  gd_real yaw_sigma_deg() const { return state_.yaw_sigma_deg; }
  gd_real bias_dps() const { return state_.bias_dps; }
  gd_real bias_sigma_dps() const { return state_.bias_sigma_dps; }
  gd_real rest_probability() const { return state_.rest_probability; }
  gd_real correction_deg() const { return state_.correction_deg; }
  gd_real roll_deg() const { return gd_roll_deg(state_.q); }
  gd_real pitch_deg() const { return gd_pitch_deg(state_.q); }
  gd_real tilt_deg() const { return state_.tilt_deg; }
  gd_real tilt_sigma_deg() const { return state_.tilt_sigma_deg; }
  gd_attitude &state() { return state_; }

private:
  gd_attitude state_;
};

typedef HdrOf<sizeof(gd_real)> Hdr;
typedef RestlevelOf<sizeof(gd_real), GD_RESTLEVEL_HYPOTHESES, GD_RESTLEVEL_AUXILIARY, GD_RESTLEVEL_MEMORY,
                    GD_RESTLEVEL_GAPS, GD_RESTLEVEL_WORK, GD_RESTLEVEL_AIDS>
    Restlevel;
typedef AttitudeOf<sizeof(gd_real), GD_ATTITUDE_HYPOTHESES, GD_ATTITUDE_QUEUE> Attitude;

} /* namespace gyrodrift */
} /* extern "C++" */
#endif

#endif
