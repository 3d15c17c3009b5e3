// Yaw of an MPU-6050 (GY-521) with its temperature, and with the calibration of my_gyro.h if there is one.
//
// `gyrodrift firmware --target arduino --config my.yaml` writes my_gyro.h into the library. Wires to an Uno: VCC to 5V,
// GND to GND, SCL to A5, SDA to A4. Serial monitor at 115200 baud.

#include <Wire.h>
#include <gyrodrift.h>

#ifdef __has_include
#if __has_include(<my_gyro.h>)
#include <my_gyro.h>
#define HAS_MY_GYRO
#endif
#endif
#ifndef HAS_MY_GYRO
static const gd_hdr_params MY_GYRO_HDR = GD_HDR_DEFAULTS;
static const gd_restlevel_params MY_GYRO_RESTLEVEL = GD_RESTLEVEL_DEFAULTS;
static const gd_calibration MY_GYRO_CALIBRATION = GD_NO_CALIBRATION;
#endif

static const uint8_t ADDRESS = 0x68; // 0x69 if AD0 is high
static const uint32_t SAMPLE_US = 10000;
static const uint8_t SAMPLES_PER_LINE = 50;

// An Uno has just enough flash for restlevel. A Leonardo has not, and runs HDR, which has no standard deviation.
#if defined(__AVR_ATmega32U4__)
static gyrodrift::Hdr filter(MY_GYRO_HDR);
static void print_sigma() {}
#else
static gyrodrift::Restlevel filter(MY_GYRO_RESTLEVEL);
static void print_sigma() {
  Serial.print(F(" +- "));
  Serial.print(filter.yaw_sigma_deg(), 2);
}
#endif

static uint32_t sample_us;
static uint8_t samples;

static void write_register(uint8_t reg, uint8_t value) {
  Wire.beginTransmission(ADDRESS);
  Wire.write(reg);
  Wire.write(value);
  Wire.endTransmission();
}

static int16_t read_value() {
  const uint8_t high = (uint8_t)Wire.read(); // the high byte comes first
  const uint8_t low = (uint8_t)Wire.read();
  return (int16_t)((uint16_t)high << 8 | low);
}

// Temperature, x, y and z follow each other in the registers.
static bool read_gyro(float *rate_dps, float *temp_c) {
  Wire.beginTransmission(ADDRESS);
  Wire.write(0x41); // TEMP_OUT_H
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(ADDRESS, (uint8_t)8) != 8) {
    return false;
  }
  *temp_c = (float)read_value() / 340.0f + 36.53f;
  read_value(); // x
  read_value(); // y
  *rate_dps = (float)read_value() / 131.0f;
  return true;
}

void setup() {
  Serial.begin(115200);
  Wire.begin();
  Wire.setClock(400000);
  write_register(0x6B, 0x01); // PWR_MGMT_1: awake, clock of the gyro
  write_register(0x1A, 0x03); // CONFIG: low-pass of 42 Hz
  write_register(0x1B, 0x00); // GYRO_CONFIG: 250 deg/s
}

void loop() {
  const uint32_t now_us = micros();
  float rate_dps, temp_c;
  if (now_us - sample_us < SAMPLE_US) {
    filter.work(); /* a portion of 2 ms at most, so that no sample waits */
    return;
  }
  sample_us = now_us;
  if (read_gyro(&rate_dps, &temp_c)) {
    filter.update_us(now_us, gd_calibrated_dps(&MY_GYRO_CALIBRATION, rate_dps, temp_c));
  }
  if (++samples == SAMPLES_PER_LINE) {
    samples = 0;
    Serial.print(filter.yaw_deg(), 2);
    print_sigma();
    Serial.println(F(" deg"));
  }
}
