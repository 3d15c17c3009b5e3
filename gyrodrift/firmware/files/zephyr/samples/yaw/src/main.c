/* Yaw of the gyro with the alias gyro0, with its standard deviation, once a second. */
#include <zephyr/device.h>
#include <zephyr/drivers/sensor.h>
#include <zephyr/kernel.h>

#include "gyrodrift.h"

#define SAMPLES_PER_LINE 100
#define DEG_PER_RAD 57.29577951308232

static gd_restlevel filter;

int main(void)
{
	const struct device *const gyro = DEVICE_DT_GET(DT_ALIAS(gyro0));
	struct sensor_value rate;

	if (!device_is_ready(gyro)) {
		printk("the gyro does not answer: check supply, SDA and SCL\n");
		return 0;
	}
	gd_restlevel_init(&filter, NULL);
	for (uint32_t count = 1;; count++) {
		k_msleep(10);
		const uint32_t t_us = (uint32_t)k_ticks_to_us_floor64((uint64_t)k_uptime_ticks());

		if (sensor_sample_fetch(gyro) != 0 || sensor_channel_get(gyro, SENSOR_CHAN_GYRO_Z, &rate) != 0) {
			continue; /* a missing sample costs only its own time */
		}
		gd_restlevel_update_us(&filter, t_us, (gd_real)(sensor_value_to_double(&rate) * DEG_PER_RAD));
		if (count % SAMPLES_PER_LINE == 0) {
			printk("yaw %.2f +- %.2f deg, bias %.3f deg/s\n", (double)filter.yaw_deg,
			       (double)filter.yaw_sigma_deg, (double)filter.bias_dps);
		}
	}
}
