/* Three gyros as their makers' papers describe them, as far as a device that reads rates and accelerations uses them.

   A model knows registers and counts, and neither time nor bus: whoever plays it asks how often it measures, gives it a
   rate and a temperature each time, and hands over what is written and read. It shares nothing with the firmware.
*/
#ifndef GYROS_H
#define GYROS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef struct gyro gyro;

typedef struct {
  const char *name;
  uint8_t address;
  void (*reset)(gyro *chip);
  void (*written)(gyro *chip, uint8_t reg, uint8_t value);
  double (*rate_hz)(const gyro *chip); /* 0 while it does not measure */
  double (*range_dps)(const gyro *chip);
  double (*low_pass_hz)(const gyro *chip);
  double (*counts_per_dps)(const gyro *chip);
  double (*counts_per_g)(const gyro *chip); /* 0 while the accelerometer does not measure */
  double (*accel_low_pass_hz)(const gyro *chip); /* NAN where the papers give none for the setting */
  double (*temperature)(double temp_c); /* counts */
  bool (*raises_pin)(const gyro *chip);
  bool is_latched; /* the pin stays high until the rates are read */
  uint8_t temp_reg, rates_reg, accels_reg;
  bool is_big_endian;
} gyro_model;

struct gyro {
  const gyro_model *model;
  uint8_t registers[4][256];
  uint8_t bank;
};

static void gyro_reset(gyro *chip) {
  memset(chip->registers, 0, sizeof chip->registers);
  chip->bank = 0;
  chip->model->reset(chip);
}

static uint8_t gyro_read(const gyro *chip, uint8_t reg) { return chip->registers[chip->bank][reg]; }

static void gyro_write_register(gyro *chip, uint8_t reg, uint8_t value) {
  chip->registers[chip->bank][reg] = value;
  chip->model->written(chip, reg, value);
}

static void gyro_put(gyro *chip, uint8_t reg, int16_t counts) {
  const uint8_t high = (uint8_t)((uint16_t)counts >> 8), low = (uint8_t)counts;
  chip->registers[0][reg] = chip->model->is_big_endian ? high : low;
  chip->registers[0][reg + 1] = chip->model->is_big_endian ? low : high;
}

static int16_t gyro_counts(double value) {
  return (int16_t)fmax(-32768.0, fmin(32767.0, floor(value + 0.5)));
}

/* Three values of 16 bits from a register on. */
static void gyro_put_axes(gyro *chip, uint8_t reg, const int16_t *counts) {
  int axis;
  for (axis = 0; axis < 3; axis++) {
    gyro_put(chip, (uint8_t)(reg + 2 * axis), counts[axis]);
  }
}

/* One measurement: into the registers, and its counts for the caller. */
static void gyro_measure(gyro *chip, const double *rates_dps, const double *accels_g, double temp_c, int16_t *rates,
                         int16_t *accels) {
  int axis;
  for (axis = 0; axis < 3; axis++) {
    rates[axis] = gyro_counts(rates_dps[axis] * chip->model->counts_per_dps(chip));
    accels[axis] = gyro_counts(accels_g[axis] * chip->model->counts_per_g(chip));
  }
  gyro_put_axes(chip, chip->model->rates_reg, rates);
  gyro_put_axes(chip, chip->model->accels_reg, accels);
  gyro_put(chip, chip->model->temp_reg, gyro_counts(chip->model->temperature(temp_c)));
}

/* MPU-6050: RM-MPU-6000A 4.2. Asleep after a reset; 8 kHz inside without the low-pass, 1 kHz with it. */

static void mpu_reset(gyro *chip) {
  chip->registers[0][0x6B] = 0x40;
  chip->registers[0][0x75] = 0x68;
}

static void mpu_written(gyro *chip, uint8_t reg, uint8_t value) {
  if (reg == 0x6B && (value & 0x80)) {
    gyro_reset(chip);
  }
}

static double mpu_rate_hz(const gyro *chip) {
  const uint8_t low_pass = chip->registers[0][0x1A] & 7;
  const double inside = low_pass == 0 || low_pass == 7 ? 8000.0 : 1000.0;
  return chip->registers[0][0x6B] & 0x40 ? 0.0 : inside / (1 + chip->registers[0][0x19]);
}

static double mpu_low_pass_hz(const gyro *chip) {
  static const double TABLE[] = {256, 188, 98, 42, 20, 10, 5, 256};
  return TABLE[chip->registers[0][0x1A] & 7];
}

static double mpu_range_dps(const gyro *chip) { return 250.0 * (1 << (chip->registers[0][0x1B] >> 3 & 3)); }

static double mpu_counts(const gyro *chip) { return 131.0 * 250.0 / mpu_range_dps(chip); }

static double mpu_counts_per_g(const gyro *chip) { return 16384.0 / (1 << (chip->registers[0][0x1C] >> 3 & 3)); }

static double mpu_accel_low_pass_hz(const gyro *chip) {
  static const double TABLE[] = {260, 184, 94, 44, 21, 10, 5, NAN};
  return TABLE[chip->registers[0][0x1A] & 7];
}

static double mpu_temperature(double temp_c) { return (temp_c - 36.53) * 340.0; }

static bool mpu_raises_pin(const gyro *chip) { return chip->registers[0][0x38] & 1; }

static const gyro_model MPU6050 = {
    .name = "mpu6050",
    .address = 0x68,
    .reset = mpu_reset,
    .written = mpu_written,
    .rate_hz = mpu_rate_hz,
    .range_dps = mpu_range_dps,
    .low_pass_hz = mpu_low_pass_hz,
    .counts_per_dps = mpu_counts,
    .counts_per_g = mpu_counts_per_g,
    .accel_low_pass_hz = mpu_accel_low_pass_hz,
    .temperature = mpu_temperature,
    .raises_pin = mpu_raises_pin,
    .is_latched = false,
    .temp_reg = 0x41,
    .rates_reg = 0x43,
    .accels_reg = 0x3B,
    .is_big_endian = true,
};

/* LSM6DSO: DS12140. The low-pass behind the gyro is that of its output rate; only 208 Hz is asked of it here. */

static void lsm_reset(gyro *chip) {
  chip->registers[0][0x0F] = 0x6C;
  chip->registers[0][0x12] = 0x04;
}

static void lsm_written(gyro *chip, uint8_t reg, uint8_t value) {
  if (reg == 0x12 && (value & 0x01)) {
    gyro_reset(chip);
  }
}

static double lsm_rate_hz(const gyro *chip) {
  const uint8_t odr = chip->registers[0][0x11] >> 4;
  return odr == 0 || odr > 10 ? 0.0 : 6.5 * (1 << odr);
}

static double lsm_range_dps(const gyro *chip) { return 250.0 * (1 << (chip->registers[0][0x11] >> 2 & 3)); }

static double lsm_low_pass_hz(const gyro *chip) { return lsm_rate_hz(chip) == 208.0 ? 67.0 : NAN; }

static double lsm_counts(const gyro *chip) { return 1000.0 / 8.75 * 250.0 / lsm_range_dps(chip); }

static double lsm_counts_per_g(const gyro *chip) {
  static const double MG[] = {0.061, 0.488, 0.122, 0.244}; /* FS_XL: 2, 16, 4 and 8 g */
  const uint8_t control = chip->registers[0][0x10];
  return control >> 4 == chip->registers[0][0x11] >> 4 ? 1000.0 / MG[control >> 2 & 3] : 0.0;
}

static double lsm_accel_low_pass_hz(const gyro *chip) { return chip->registers[0][0x10] & 2 ? NAN : lsm_rate_hz(chip) / 2; }

static double lsm_temperature(double temp_c) { return (temp_c - 25.0) * 256.0; }

static bool lsm_raises_pin(const gyro *chip) { return chip->registers[0][0x0D] & 2; }

static const gyro_model LSM6DSO = {
    .name = "lsm6dso",
    .address = 0x6A,
    .reset = lsm_reset,
    .written = lsm_written,
    .rate_hz = lsm_rate_hz,
    .range_dps = lsm_range_dps,
    .low_pass_hz = lsm_low_pass_hz,
    .counts_per_dps = lsm_counts,
    .counts_per_g = lsm_counts_per_g,
    .accel_low_pass_hz = lsm_accel_low_pass_hz,
    .temperature = lsm_temperature,
    .raises_pin = lsm_raises_pin,
    .is_latched = true,
    .temp_reg = 0x20,
    .rates_reg = 0x22,
    .accels_reg = 0x28,
    .is_big_endian = false,
};

/* ICM-20948: DS-000189 1.3. Four banks behind register 0x7F. */

static void icm_reset(gyro *chip) {
  chip->registers[0][0x00] = 0xEA;
  chip->registers[0][0x06] = 0x41;
  chip->registers[2][0x01] = 0x01;
}

static void icm_written(gyro *chip, uint8_t reg, uint8_t value) {
  if (reg == 0x7F) {
    chip->bank = value >> 4 & 3;
  } else if (chip->bank == 0 && reg == 0x06 && (value & 0x80)) {
    gyro_reset(chip);
  }
}

static double icm_rate_hz(const gyro *chip) {
  const double inside = chip->registers[2][0x01] & 1 ? 1125.0 : 9000.0;
  return chip->registers[0][0x06] & 0x40 ? 0.0 : inside / (1 + chip->registers[2][0x00]);
}

static double icm_low_pass_hz(const gyro *chip) {
  static const double TABLE[] = {196.6, 151.8, 119.5, 51.2, 23.9, 11.6, 5.7, 361.4};
  return TABLE[chip->registers[2][0x01] >> 3 & 7];
}

static double icm_range_dps(const gyro *chip) { return 250.0 * (1 << (chip->registers[2][0x01] >> 1 & 3)); }

static double icm_counts(const gyro *chip) { return 131.0 * 250.0 / icm_range_dps(chip); }

/* The accelerometer has a rate of its own; it must be that of the gyro. */
static double icm_counts_per_g(const gyro *chip) {
  const int divider = (chip->registers[2][0x10] & 0x0F) << 8 | chip->registers[2][0x11];
  return divider == chip->registers[2][0x00] ? 16384.0 / (1 << (chip->registers[2][0x14] >> 1 & 3)) : 0.0;
}

static double icm_accel_low_pass_hz(const gyro *chip) {
  static const double TABLE[] = {246.0, 246.0, 111.4, 50.4, 23.9, 11.5, 5.7, 473.0};
  return chip->registers[2][0x14] & 1 ? TABLE[chip->registers[2][0x14] >> 3 & 7] : 1209.0;
}

static double icm_temperature(double temp_c) { return (temp_c - 21.0) * 333.87; }

static bool icm_raises_pin(const gyro *chip) { return chip->registers[0][0x11] & 1; }

static const gyro_model ICM20948 = {
    .name = "icm20948",
    .address = 0x69,
    .reset = icm_reset,
    .written = icm_written,
    .rate_hz = icm_rate_hz,
    .range_dps = icm_range_dps,
    .low_pass_hz = icm_low_pass_hz,
    .counts_per_dps = icm_counts,
    .counts_per_g = icm_counts_per_g,
    .accel_low_pass_hz = icm_accel_low_pass_hz,
    .temperature = icm_temperature,
    .raises_pin = icm_raises_pin,
    .is_latched = false,
    .temp_reg = 0x39,
    .rates_reg = 0x33,
    .accels_reg = 0x2D,
    .is_big_endian = true,
};

static const gyro_model *const GYRO_MODELS[] = {&MPU6050, &LSM6DSO, &ICM20948};

#endif
