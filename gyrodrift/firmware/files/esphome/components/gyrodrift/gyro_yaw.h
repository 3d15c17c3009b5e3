/* Component of ESPHome that reads a gyro on I2C and filters its rate; see sensor.py. */
#pragma once

#include "esphome/components/i2c/i2c.h"
#include "esphome/components/sensor/sensor.h"
#include "esphome/core/component.h"
#include "esphome/core/helpers.h"

#include "gyrodrift.h"

namespace esphome {
namespace gyrodrift_yaw {

enum Model : uint8_t { MPU6050, LSM6DS3, LSM6DSO };
enum Kind : uint8_t { RESTLEVEL, HDR };

class GyroYaw : public PollingComponent, public i2c::I2CDevice {
 public:
  void setup() override;
  void loop() override;
  void update() override;
  void dump_config() override;
  float get_setup_priority() const override { return setup_priority::DATA; }

  void set_model(Model model) { this->model_ = model; }
  void set_kind(Kind kind) { this->kind_ = kind; }
  void set_axis(uint8_t axis, bool is_upside_down) {
    this->axis_ = axis;
    this->sign_ = is_upside_down ? -1.0f : 1.0f;
  }
  void set_sample_interval_us(uint32_t interval_us) { this->interval_us_ = interval_us; }
  void set_yaw(sensor::Sensor *yaw) { this->yaw_ = yaw; }
  void set_yaw_sigma(sensor::Sensor *yaw_sigma) { this->yaw_sigma_ = yaw_sigma; }
  void set_bias(sensor::Sensor *bias) { this->bias_ = bias; }
  void set_temperature(sensor::Sensor *temperature) { this->temperature_ = temperature; }

 protected:
  bool start_gyro_();
  bool read_gyro_(float *rate_dps, float *temp_c);

  Model model_{MPU6050};
  Kind kind_{RESTLEVEL};
  uint8_t axis_{2};
  float sign_{1.0f};
  uint32_t interval_us_{10000};
  uint32_t sample_us_{0};
  float temp_c_{NAN};
  gd_restlevel restlevel_;
  gd_hdr hdr_;
  HighFrequencyLoopRequester fast_loop_;
  sensor::Sensor *yaw_{nullptr};
  sensor::Sensor *yaw_sigma_{nullptr};
  sensor::Sensor *bias_{nullptr};
  sensor::Sensor *temperature_{nullptr};
};

}  // namespace gyrodrift_yaw
}  // namespace esphome
