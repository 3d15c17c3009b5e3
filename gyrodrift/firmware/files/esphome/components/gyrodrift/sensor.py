"""Sensors for ESPHome: yaw of a gyro on I2C, its standard deviation, the bias, and the temperature of the gyro."""

import esphome.codegen as cg
import esphome.config_validation as cv
from esphome.components import i2c, sensor
from esphome.const import (
    CONF_FILTER,
    CONF_ID,
    CONF_MODEL,
    CONF_TEMPERATURE,
    DEVICE_CLASS_TEMPERATURE,
    STATE_CLASS_MEASUREMENT,
    UNIT_CELSIUS,
    UNIT_DEGREES,
)

DEPENDENCIES = ["i2c"]

CONF_AXIS = "axis"
CONF_BIAS = "bias"
CONF_IS_UPSIDE_DOWN = "is_upside_down"
CONF_SAMPLE_INTERVAL = "sample_interval"
CONF_YAW = "yaw"
CONF_YAW_SIGMA = "yaw_sigma"
ICON = "mdi:rotate-right"

gyrodrift_ns = cg.esphome_ns.namespace("gyrodrift_yaw")
GyroYaw = gyrodrift_ns.class_("GyroYaw", cg.PollingComponent, i2c.I2CDevice)
Model = gyrodrift_ns.enum("Model")
Kind = gyrodrift_ns.enum("Kind")

MODELS = {"MPU6050": Model.MPU6050, "LSM6DS3": Model.LSM6DS3, "LSM6DSO": Model.LSM6DSO}
KINDS = {"restlevel": Kind.RESTLEVEL, "hdr": Kind.HDR}
AXES = {"x": 0, "y": 1, "z": 2}


def _angle(decimals: int) -> cv.Schema:
    return sensor.sensor_schema(
        unit_of_measurement=UNIT_DEGREES,
        icon=ICON,
        accuracy_decimals=decimals,
        state_class=STATE_CLASS_MEASUREMENT,
    )


CONFIG_SCHEMA = (
    cv.Schema(
        {
            cv.GenerateID(): cv.declare_id(GyroYaw),
            cv.Optional(CONF_MODEL, default="MPU6050"): cv.enum(MODELS, upper=True),
            cv.Optional(CONF_FILTER, default="restlevel"): cv.enum(KINDS, lower=True),
            cv.Optional(CONF_AXIS, default="z"): cv.enum(AXES, lower=True),
            cv.Optional(CONF_IS_UPSIDE_DOWN, default=False): cv.boolean,
            cv.Optional(CONF_SAMPLE_INTERVAL, default="10ms"): cv.All(
                cv.positive_time_period_microseconds,
                cv.Range(min=cv.TimePeriod(milliseconds=4), max=cv.TimePeriod(milliseconds=50)),
            ),
            cv.Optional(CONF_YAW): _angle(1),
            cv.Optional(CONF_YAW_SIGMA): _angle(2),
            cv.Optional(CONF_BIAS): sensor.sensor_schema(
                unit_of_measurement="°/s", icon=ICON, accuracy_decimals=3, state_class=STATE_CLASS_MEASUREMENT
            ),
            cv.Optional(CONF_TEMPERATURE): sensor.sensor_schema(
                unit_of_measurement=UNIT_CELSIUS,
                accuracy_decimals=1,
                device_class=DEVICE_CLASS_TEMPERATURE,
                state_class=STATE_CLASS_MEASUREMENT,
            ),
        }
    )
    .extend(cv.polling_component_schema("1s"))
    .extend(i2c.i2c_device_schema(0x68))
)


async def to_code(config: dict) -> None:
    """Write the C++ that sets the component up."""
    var = cg.new_Pvariable(config[CONF_ID])
    await cg.register_component(var, config)
    await i2c.register_i2c_device(var, config)
    cg.add(var.set_model(config[CONF_MODEL]))
    cg.add(var.set_kind(config[CONF_FILTER]))
    cg.add(var.set_axis(config[CONF_AXIS], config[CONF_IS_UPSIDE_DOWN]))
    cg.add(var.set_sample_interval_us(config[CONF_SAMPLE_INTERVAL]))
    for name in (CONF_YAW, CONF_YAW_SIGMA, CONF_BIAS, CONF_TEMPERATURE):
        if name in config:
            cg.add(getattr(var, f"set_{name}")(await sensor.new_sensor(config[name])))
