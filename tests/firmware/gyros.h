/* Three gyros as their makers' papers describe them, as far as a device that reads the rate uses them.

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
  double (*temperature)(double temp_c); /* counts */
  bool (*raises_pin)(const gyro *chip);
  bool is_latched; /* the pin stays high until the rates are read */
  uint8_t temp_reg, rates_reg;
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

/* One measurement: into the registers; the counts of the rate about z. */
static int16_t gyro_measure(gyro *chip, double rate_dps, double temp_c) {
  const double per_dps = chip->model->counts_per_dps(chip);
  const int16_t z = gyro_counts(rate_dps * per_dps);
  gyro_put(chip, chip->model->rates_reg, gyro_counts(1.5 * per_dps)); /* the other axes have a bias and nothing else */
  gyro_put(chip, (uint8_t)(chip->model->rates_reg + 2), gyro_counts(-2.5 * per_dps));
  gyro_put(chip, (uint8_t)(chip->model->rates_reg + 4), z);
  gyro_put(chip, chip->model->temp_reg, gyro_counts(chip->model->temperature(temp_c)));
  return z;
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

static double mpu_temperature(double temp_c) { return (temp_c - 36.53) * 340.0; }

static bool mpu_raises_pin(const gyro *chip) { return chip->registers[0][0x38] & 1; }

static const gyro_model MPU6050 = {"mpu6050",       0x68,       mpu_reset,  mpu_written,     mpu_rate_hz,
                                   mpu_range_dps,   mpu_low_pass_hz, mpu_counts, mpu_temperature, mpu_raises_pin,
                                   false,           0x41,       0x43,       true};

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

static double lsm_temperature(double temp_c) { return (temp_c - 25.0) * 256.0; }

static bool lsm_raises_pin(const gyro *chip) { return chip->registers[0][0x0D] & 2; }

static const gyro_model LSM6DSO = {"lsm6dso",       0x6A,       lsm_reset,  lsm_written,     lsm_rate_hz,
                                   lsm_range_dps,   lsm_low_pass_hz, lsm_counts, lsm_temperature, lsm_raises_pin,
                                   true,            0x20,       0x22,       false};

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

static double icm_temperature(double temp_c) { return (temp_c - 21.0) * 333.87; }

static bool icm_raises_pin(const gyro *chip) { return chip->registers[0][0x11] & 1; }

static const gyro_model ICM20948 = {"icm20948",      0x69,       icm_reset,  icm_written,     icm_rate_hz,
                                    icm_range_dps,   icm_low_pass_hz, icm_counts, icm_temperature, icm_raises_pin,
                                    false,           0x39,       0x33,       true};

static const gyro_model *const GYRO_MODELS[] = {&MPU6050, &LSM6DSO, &ICM20948};

#endif
