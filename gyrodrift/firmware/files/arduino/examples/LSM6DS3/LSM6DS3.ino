// Yaw of an LSM6DS3 with its temperature, and with the calibration of my_gyro.h if there is one.
//
// `gyrodrift firmware --target arduino --config my.yaml` writes my_gyro.h into the library. Wires to an Uno: VIN to 5V
// of a breakout with its own regulator, GND to GND, SCL to A5, SDA to A4. Serial monitor at 115200 baud.

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

static const uint8_t ADDRESS = 0x6A; // 0x6B if SA0 is high
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
  const uint8_t low = (uint8_t)Wire.read(); // the low byte comes first
  const uint8_t high = (uint8_t)Wire.read();
  return (int16_t)((uint16_t)high << 8 | low);
}

// Temperature, x, y and z follow each other in the registers.
static bool read_gyro(float *rate_dps, float *temp_c) {
  Wire.beginTransmission(ADDRESS);
  Wire.write(0x20); // OUT_TEMP_L
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(ADDRESS, (uint8_t)8) != 8) {
    return false;
  }
  *temp_c = (float)read_value() / 16.0f + 25.0f; // 256.0f for LSM6DSO, LSM6DSL and LSM6DS3TR-C
  read_value(); // x
  read_value(); // y
  *rate_dps = (float)read_value() * 0.00875f;
  return true;
}

void setup() {
  Serial.begin(115200);
  Wire.begin();
  Wire.setClock(400000);
  write_register(0x12, 0x44); // CTRL3_C: block data update, addresses increment
  write_register(0x11, 0x50); // CTRL2_G: 208 Hz, 250 deg/s
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
