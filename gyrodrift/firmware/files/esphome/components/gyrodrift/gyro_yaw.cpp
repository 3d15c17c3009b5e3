/* Registers and scales: InvenSense RM-MPU-6000A 4.2, ST DocID026899 (LSM6DS3), ST DS12140 (LSM6DSO). */
#include "gyro_yaw.h"

#include "esphome/core/hal.h"
#include "esphome/core/log.h"

/* Parameters and calibration of your gyro, if `gyrodrift firmware --config` wrote them. */
#if __has_include("my_gyro.h")
#include "my_gyro.h"
#else
static const gd_hdr_params MY_GYRO_HDR = GD_HDR_DEFAULTS;
static const gd_restlevel_params MY_GYRO_RESTLEVEL = GD_RESTLEVEL_DEFAULTS;
static const gd_calibration MY_GYRO_CALIBRATION = GD_NO_CALIBRATION;
#endif

namespace esphome {
namespace gyrodrift_yaw {

static const char *const TAG = "gyrodrift";

struct Write {
  uint8_t reg, value;
};

static const Write MPU6050_WRITES[] = {
    {0x6B, 0x01}, /* PWR_MGMT_1: awake, clock of the gyro's x axis */
    {0x1A, 0x03}, /* CONFIG: low-pass of 42 Hz */
    {0x1B, 0x00}, /* GYRO_CONFIG: 250 deg/s */
};

static const Write LSM6DS_WRITES[] = {
    {0x12, 0x44}, /* CTRL3_C: block data update, addresses increment */
    {0x11, 0x50}, /* CTRL2_G: 208 Hz, 250 deg/s */
};

void GyroYaw::setup() {
  gd_restlevel_init(&this->restlevel_, &MY_GYRO_RESTLEVEL);
  gd_hdr_init(&this->hdr_, &MY_GYRO_HDR);
  if (!this->start_gyro_()) {
    this->mark_failed();
    return;
  }
  this->fast_loop_.start();
}

bool GyroYaw::start_gyro_() {
  const bool is_mpu = this->model_ == MPU6050;
  const Write *writes = is_mpu ? MPU6050_WRITES : LSM6DS_WRITES;
  const uint8_t count = is_mpu ? 3 : 2;
  uint8_t who = 0;
  if (!this->read_byte(is_mpu ? 0x75 : 0x0F, &who)) {
    return false;
  }
  ESP_LOGD(TAG, "WHO_AM_I is 0x%02X", who);
  for (uint8_t i = 0; i < count; i++) {
    if (!this->write_byte(writes[i].reg, writes[i].value)) {
      return false;
    }
  }
  return true;
}

/* Temperature and rates come from one burst: x, y and z of both sensors follow each other. */
bool GyroYaw::read_gyro_(float *rate_dps, float *temp_c) {
  uint8_t bytes[8];
  const bool is_mpu = this->model_ == MPU6050;
  if (!this->read_bytes(is_mpu ? 0x41 : 0x20, bytes, sizeof bytes)) {
    return false;
  }
  const uint8_t *rate = bytes + 2 + 2 * this->axis_;
  const uint8_t high = is_mpu ? 0 : 1, low = is_mpu ? 1 : 0;
  const int16_t rate_raw = (int16_t)(uint16_t)(rate[high] << 8 | rate[low]);
  const int16_t temp_raw = (int16_t)(uint16_t)(bytes[high] << 8 | bytes[low]);
  *rate_dps = this->sign_ * (float)rate_raw * (is_mpu ? 1.0f / 131.0f : 0.00875f);
  *temp_c = is_mpu ? (float)temp_raw / 340.0f + 36.53f
                   : (float)temp_raw / (this->model_ == LSM6DS3 ? 16.0f : 256.0f) + 25.0f;
  return true;
}

void GyroYaw::loop() {
  const uint32_t now_us = micros();
  float rate_dps;
  if (now_us - this->sample_us_ < this->interval_us_) {
    return;
  }
  this->sample_us_ = now_us;
  if (!this->read_gyro_(&rate_dps, &this->temp_c_)) {
    this->status_set_warning();
    return;
  }
  this->status_clear_warning();
  rate_dps = gd_calibrated_dps(&MY_GYRO_CALIBRATION, rate_dps, this->temp_c_);
  if (this->kind_ == HDR) {
    gd_hdr_update_us(&this->hdr_, now_us, rate_dps);
  } else {
    gd_restlevel_update_us(&this->restlevel_, now_us, rate_dps);
  }
}

void GyroYaw::update() {
  const bool is_hdr = this->kind_ == HDR;
  if (this->yaw_ != nullptr) {
    this->yaw_->publish_state(is_hdr ? this->hdr_.yaw_deg : this->restlevel_.yaw_deg);
  }
  if (this->yaw_sigma_ != nullptr && !is_hdr) { /* HDR has none */
    this->yaw_sigma_->publish_state(this->restlevel_.yaw_sigma_deg);
  }
  if (this->bias_ != nullptr) {
    this->bias_->publish_state(is_hdr ? this->hdr_.bias_dps : this->restlevel_.bias_dps);
  }
  if (this->temperature_ != nullptr) {
    this->temperature_->publish_state(this->temp_c_);
  }
}

void GyroYaw::dump_config() {
  ESP_LOGCONFIG(TAG, "gyrodrift:");
  LOG_I2C_DEVICE(this);
  ESP_LOGCONFIG(TAG, "  Filter: %s", this->kind_ == HDR ? "hdr" : "restlevel");
  ESP_LOGCONFIG(TAG, "  Sample interval: %u us", (unsigned) this->interval_us_);
  if (this->is_failed()) {
    ESP_LOGE(TAG, "The gyro does not answer: check supply, SDA, SCL and the address");
  }
  LOG_UPDATE_INTERVAL(this);
}

}  // namespace gyrodrift_yaw
}  // namespace esphome
