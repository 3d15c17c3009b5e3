/* The header of the firmware as a library, for callers who are not C. */
#include "gyrodrift_native.h"

int hello_frame(uint8_t *frame, uint16_t sample_rate_hz, float dps_per_lsb, uint32_t encoder_cpr, const char *device_id) {
  const gyrodrift_hello hello = {sample_rate_hz, dps_per_lsb, encoder_cpr, device_id};
  return gyrodrift_hello_frame(frame, &hello);
}

int sample_frame(uint8_t *frame, uint8_t flags, uint16_t seq, uint32_t t_us, int16_t rate_raw, int16_t temp_centi_c,
                 int32_t encoder_counts) {
  const gyrodrift_sample sample = {flags, seq, t_us, rate_raw, temp_centi_c, encoder_counts};
  return gyrodrift_sample_frame(frame, &sample);
}

int hello3_frame(uint8_t *frame, uint16_t sample_rate_hz, float dps_per_lsb, uint32_t encoder_cpr, const char *device_id,
                 float mps2_per_lsb) {
  const gyrodrift_hello hello = {sample_rate_hz, dps_per_lsb, encoder_cpr, device_id};
  return gyrodrift_hello3_frame(frame, &hello, mps2_per_lsb);
}

int sample3_frame(uint8_t *frame, uint8_t flags, uint16_t seq, uint32_t t_us, const int16_t *axes, int16_t temp_centi_c,
                  int32_t encoder_counts) {
  const gyrodrift_sample3 sample = {flags,        seq,           t_us, {axes[0], axes[1], axes[2]}, {axes[3], axes[4], axes[5]},
                                    temp_centi_c, encoder_counts};
  return gyrodrift_sample3_frame(frame, &sample);
}

int hello_filter_frame(uint8_t *frame, uint16_t sample_rate_hz, float dps_per_lsb, uint32_t encoder_cpr,
                       const char *device_id, uint8_t axes, float mps2_per_lsb, uint8_t filter) {
  const gyrodrift_hello hello = {sample_rate_hz, dps_per_lsb, encoder_cpr, device_id};
  return gyrodrift_hello_filter_frame(frame, &hello, axes, mps2_per_lsb, filter);
}

int yaw_frame(uint8_t *frame, uint16_t seq, uint32_t t_us, float yaw_deg, float yaw_sigma_deg, float bias_dps) {
  const gyrodrift_yaw yaw = {seq, t_us, yaw_deg, yaw_sigma_deg, bias_dps};
  return gyrodrift_yaw_frame(frame, &yaw);
}
