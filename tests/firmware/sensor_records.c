/* The records of the sketch's sensors, a line of JSON each. */
#include <stdio.h>

#include "gyro_sensors.h"

int main(void) {
  size_t i, j;
  for (i = 0; i < GYRO_SENSOR_COUNT; i++) {
    const gyro_sensor *s = &GYRO_SENSORS[i];
    printf("{\"id\": \"%s\", \"addresses\": [%d, %d], \"who_reg\": %d, \"who\": %d, \"writes\": [", s->id,
           s->addresses[0], s->addresses[1], s->who_reg, s->who);
    for (j = 0; j < s->write_count; j++) {
      printf("%s[%d, %d]", j ? ", " : "", s->writes[j].reg, s->writes[j].value);
    }
    printf("], \"burst_reg\": %d, \"temp_at\": %d, \"rates_at\": %d, \"accels_at\": %d, \"is_big_endian\": %s, ", s->burst_reg,
           s->temp_at, s->rates_at, s->accels_at, s->is_big_endian ? "true" : "false");
    printf("\"sample_rate_hz\": %d, \"dps_per_lsb\": %.9g, \"mps2_per_lsb\": %.9g, ", s->sample_rate_hz,
           (double)s->dps_per_lsb, (double)s->mps2_per_lsb);
    printf("\"c_per_lsb\": %.9g, \"c_at_zero\": %.9g}\n", (double)s->c_per_lsb, (double)s->c_at_zero);
  }
  return 0;
}
