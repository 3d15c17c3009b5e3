"""Gyros on I2C: how to recognize each sensor, how to set it up, and where its values are.

Registers and scales are from the data sheets: InvenSense RM-MPU-6000A 4.2, TDK DS-000189 1.3 (ICM-20948), ST
DocID026899 (LSM6DS3), ST DS12140 (LSM6DSO). All sensors are set to 250 deg/s, 8 g and about 200 Hz. They raise
their interrupt pin when a measurement is ready.
"""

from collections import namedtuple

BURST_BYTES = 14
"""Temperature, rates and accelerations of x, y and z, in consecutive registers."""

GyroSensor = namedtuple(
    "GyroSensor",
    (
        "id",  # for HELLO: sensor, range in deg/s, low-pass in Hz; at most 16 characters
        "addresses",
        "who_reg",
        "who",  # value of its WHO_AM_I
        "writes",  # registers and values; the first resets it
        "burst_reg",  # first register of the burst
        "temp_at",  # index in the burst; rates_at and accels_at: index of x, then y and z
        "rates_at",
        "accels_at",
        "is_big_endian",
        "sample_rate_hz",
        "dps_per_lsb",
        "mps2_per_lsb",
        "centi_c",  # hundredths of a degree C are raw * centi_c[0] / centi_c[1] + centi_c[2]
    ),
)

MPU6050_WRITES = (
    (0x6B, 0x80),  # PWR_MGMT_1: reset
    (0x6B, 0x01),  # PWR_MGMT_1: awake, clock of the gyro's x axis
    (0x1A, 0x03),  # CONFIG: low-pass of 42 Hz, internal rate 1 kHz
    (0x19, 0x04),  # SMPLRT_DIV: 1 kHz / (1 + 4)
    (0x1B, 0x00),  # GYRO_CONFIG: 250 deg/s
    (0x1C, 0x10),  # ACCEL_CONFIG: 8 g
    (0x37, 0x00),  # INT_PIN_CFG: a pulse of 50 us, high
    (0x38, 0x01),  # INT_ENABLE: data ready
)

LSM6DS_WRITES = (
    (0x12, 0x01),  # CTRL3_C: reset
    (0x12, 0x44),  # CTRL3_C: block data update, addresses increment
    (0x10, 0x5C),  # CTRL1_XL: 208 Hz, 8 g
    (0x0D, 0x02),  # INT1_CTRL: gyro data ready; high until the rates are read
    (0x11, 0x50),  # CTRL2_G: 208 Hz, 250 deg/s; the rate sets the low-pass
)

LSM6DSO_WRITES = (
    (0x12, 0x01),  # CTRL3_C: reset
    (0x12, 0x44),  # CTRL3_C: block data update, addresses increment
    (0x18, 0xE2),  # CTRL9_XL: I2C without I3C
    (0x10, 0x5C),  # CTRL1_XL: 208 Hz, 8 g
    (0x0D, 0x02),  # INT1_CTRL: gyro data ready; high until the rates are read
    (0x11, 0x50),  # CTRL2_G: 208 Hz, 250 deg/s; the rate sets the low-pass
)

ICM20948_WRITES = (
    (0x06, 0x80),  # PWR_MGMT_1: reset
    (0x06, 0x01),  # PWR_MGMT_1: awake, best clock
    (0x7F, 0x20),  # bank 2
    (0x00, 0x04),  # GYRO_SMPLRT_DIV: 1125 Hz / (1 + 4)
    (0x01, 0x19),  # GYRO_CONFIG_1: low-pass of 51 Hz, 250 deg/s
    (0x10, 0x00),  # ACCEL_SMPLRT_DIV_1
    (0x11, 0x04),  # ACCEL_SMPLRT_DIV_2: 1125 Hz / (1 + 4)
    (0x14, 0x1D),  # ACCEL_CONFIG: low-pass of 50 Hz, 8 g
    (0x7F, 0x00),  # bank 0
    (0x0F, 0x00),  # INT_PIN_CFG: a pulse of 50 us, high
    (0x11, 0x01),  # INT_ENABLE_1: data ready
)

MPU6050_C = (100, 340, 3653)
LSM6DS3_C = (100, 16, 2500)
LSM6DS_C = (100, 256, 2500)
ICM20948_C = (10000, 33387, 2100)

MPU = (0x68, 0x69)
LSM = (0x6A, 0x6B)
ICM = (0x69, 0x68)

MPU_MPS2 = 9.80665 / 4096
LSM_MPS2 = 9.80665 * 0.000244
"""One count of the acceleration, m/s²: 4096 per g, and 0.244 mg."""

SENSORS = (
    GyroSensor(
        "MPU-6050 250/42", MPU, 0x75, 0x68, MPU6050_WRITES, 0x3B, 6, 8, 0, True, 200, 1 / 131, MPU_MPS2, MPU6050_C
    ),
    GyroSensor(
        "LSM6DS3 250/67", LSM, 0x0F, 0x69, LSM6DS_WRITES, 0x20, 0, 2, 8, False, 208, 0.00875, LSM_MPS2, LSM6DS3_C
    ),
    # LSM6DS3TR-C too
    GyroSensor(
        "LSM6DSL 250/67", LSM, 0x0F, 0x6A, LSM6DS_WRITES, 0x20, 0, 2, 8, False, 208, 0.00875, LSM_MPS2, LSM6DS_C
    ),
    # LSM6DSOX too
    GyroSensor(
        "LSM6DSO 250/67", LSM, 0x0F, 0x6C, LSM6DSO_WRITES, 0x20, 0, 2, 8, False, 208, 0.00875, LSM_MPS2, LSM6DS_C
    ),
    GyroSensor(
        "ICM-20948 250/51", ICM, 0x00, 0xEA, ICM20948_WRITES, 0x2D, 12, 6, 0, True, 225, 1 / 131, MPU_MPS2, ICM20948_C
    ),
)
