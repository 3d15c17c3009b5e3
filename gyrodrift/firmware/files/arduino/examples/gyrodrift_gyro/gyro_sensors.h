/* Gyros on I2C: how to recognize each sensor, how to set it up, and where its values are.

   Registers and scales are from the data sheets: InvenSense RM-MPU-6000A 4.2, TDK DS-000189 1.3 (ICM-20948), ST
   DocID026899 (LSM6DS3), ST DS12140 (LSM6DSO). All sensors are set to 250 deg/s, 8 g and about 200 Hz. They raise their
   interrupt pin when a measurement is ready.
*/
#ifndef GYRO_SENSORS_H
#define GYRO_SENSORS_H

#include <stdint.h>

#define GYRO_BURST_BYTES 14 /* temperature, rates and accelerations of x, y and z, in consecutive registers */

typedef struct {
  uint8_t reg;
  uint8_t value;
} gyro_write;

typedef struct {
  const char *id; /* for HELLO: sensor, range in deg/s, low-pass in Hz; at most 16 characters */
  uint8_t addresses[2];
  uint8_t who_reg;
  uint8_t who; /* value of its WHO_AM_I */
  const gyro_write *writes; /* the first resets it */
  uint8_t write_count;
  uint8_t burst_reg; /* first register of the burst */
  uint8_t temp_at; /* index in the burst; rates_at and accels_at: index of x, then y and z */
  uint8_t rates_at;
  uint8_t accels_at;
  uint8_t is_big_endian;
  uint16_t sample_rate_hz;
  float dps_per_lsb;
  float mps2_per_lsb;
  float c_per_lsb;
  float c_at_zero; /* temperature at the register value 0 */
} gyro_sensor;

#define GYRO_WRITES(writes) writes, (uint8_t)(sizeof(writes) / sizeof(writes)[0])

static const gyro_write MPU6050_WRITES[] = {
    {0x6B, 0x80}, /* PWR_MGMT_1: reset */
    {0x6B, 0x01}, /* PWR_MGMT_1: awake, clock of the gyro's x axis */
    {0x1A, 0x03}, /* CONFIG: low-pass of 42 Hz, internal rate 1 kHz */
    {0x19, 0x04}, /* SMPLRT_DIV: 1 kHz / (1 + 4) */
    {0x1B, 0x00}, /* GYRO_CONFIG: 250 deg/s */
    {0x1C, 0x10}, /* ACCEL_CONFIG: 8 g */
    {0x37, 0x00}, /* INT_PIN_CFG: a pulse of 50 us, high */
    {0x38, 0x01}, /* INT_ENABLE: data ready */
};

static const gyro_write LSM6DS_WRITES[] = {
    {0x12, 0x01}, /* CTRL3_C: reset */
    {0x12, 0x44}, /* CTRL3_C: block data update, addresses increment */
    {0x10, 0x5C}, /* CTRL1_XL: 208 Hz, 8 g */
    {0x0D, 0x02}, /* INT1_CTRL: gyro data ready; high until the rates are read */
    {0x11, 0x50}, /* CTRL2_G: 208 Hz, 250 deg/s; the rate sets the low-pass */
};

static const gyro_write LSM6DSO_WRITES[] = {
    {0x12, 0x01}, /* CTRL3_C: reset */
    {0x12, 0x44}, /* CTRL3_C: block data update, addresses increment */
    {0x18, 0xE2}, /* CTRL9_XL: I2C without I3C */
    {0x10, 0x5C}, /* CTRL1_XL: 208 Hz, 8 g */
    {0x0D, 0x02}, /* INT1_CTRL: gyro data ready; high until the rates are read */
    {0x11, 0x50}, /* CTRL2_G: 208 Hz, 250 deg/s; the rate sets the low-pass */
};

static const gyro_write ICM20948_WRITES[] = {
    {0x06, 0x80}, /* PWR_MGMT_1: reset */
    {0x06, 0x01}, /* PWR_MGMT_1: awake, best clock */
    {0x7F, 0x20}, /* bank 2 */
    {0x00, 0x04}, /* GYRO_SMPLRT_DIV: 1125 Hz / (1 + 4) */
    {0x01, 0x19}, /* GYRO_CONFIG_1: low-pass of 51 Hz, 250 deg/s */
    {0x10, 0x00}, /* ACCEL_SMPLRT_DIV_1 */
    {0x11, 0x04}, /* ACCEL_SMPLRT_DIV_2: 1125 Hz / (1 + 4) */
    {0x14, 0x1D}, /* ACCEL_CONFIG: low-pass of 50 Hz, 8 g */
    {0x7F, 0x00}, /* bank 0 */
    {0x0F, 0x00}, /* INT_PIN_CFG: a pulse of 50 us, high */
    {0x11, 0x01}, /* INT_ENABLE_1: data ready */
};

#define MPS2_AT_4096 (9.80665f / 4096.0f) /* one count at 4096 per g */
#define MPS2_AT_244_UG (9.80665f * 0.000244f)

static const gyro_sensor GYRO_SENSORS[] = {
    {"MPU-6050 250/42", {0x68, 0x69}, 0x75, 0x68, GYRO_WRITES(MPU6050_WRITES),
     0x3B, 6, 8, 0, 1, 200, 1.0f / 131.0f, MPS2_AT_4096, 1.0f / 340.0f, 36.53f},
    {"LSM6DS3 250/67", {0x6A, 0x6B}, 0x0F, 0x69, GYRO_WRITES(LSM6DS_WRITES),
     0x20, 0, 2, 8, 0, 208, 0.00875f, MPS2_AT_244_UG, 1.0f / 16.0f, 25.0f},
    {"LSM6DSL 250/67", {0x6A, 0x6B}, 0x0F, 0x6A, GYRO_WRITES(LSM6DS_WRITES), /* and LSM6DS3TR-C */
     0x20, 0, 2, 8, 0, 208, 0.00875f, MPS2_AT_244_UG, 1.0f / 256.0f, 25.0f},
    {"LSM6DSO 250/67", {0x6A, 0x6B}, 0x0F, 0x6C, GYRO_WRITES(LSM6DSO_WRITES), /* and LSM6DSOX */
     0x20, 0, 2, 8, 0, 208, 0.00875f, MPS2_AT_244_UG, 1.0f / 256.0f, 25.0f},
    {"ICM-20948 250/51", {0x69, 0x68}, 0x00, 0xEA, GYRO_WRITES(ICM20948_WRITES),
     0x2D, 12, 6, 0, 1, 225, 1.0f / 131.0f, MPS2_AT_4096, 1.0f / 333.87f, 21.0f},
};

#define GYRO_SENSOR_COUNT (sizeof(GYRO_SENSORS) / sizeof(GYRO_SENSORS)[0])

#endif
