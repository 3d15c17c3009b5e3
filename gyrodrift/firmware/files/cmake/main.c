/* Filters a CSV table on this machine, as a first program with gyrodrift.h and as a check of a build.

       gyrodrift_example [hdr|restlevel] < session.csv > yaw.csv

   The first line of the table names its columns: t_device_s and rate_dps, and temp_c if the sensor has a thermometer.
   Lines that begin with # are comments. `gyrodrift convert session.mcap session.csv` writes such a table, and
   `gyrodrift filter session.csv --out yaw.csv` computes the same yaw.
*/
#define GD_REAL double
#include "gyrodrift.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Parameters and calibration of your gyro, if `gyrodrift firmware --config` wrote them. */
#ifdef __has_include
#if __has_include("my_gyro.h")
#include "my_gyro.h"
#define HAS_MY_GYRO
#endif
#endif
#ifndef HAS_MY_GYRO
static const gd_hdr_params MY_GYRO_HDR = GD_HDR_DEFAULTS;
static const gd_restlevel_params MY_GYRO_RESTLEVEL = GD_RESTLEVEL_DEFAULTS;
static const gd_calibration MY_GYRO_CALIBRATION = GD_NO_CALIBRATION;
#endif

#define LONGEST_LINE 4096
#define MISSING (-1)

typedef struct {
  int t, rate, temp;
} columns;

/* Calls `take` for each field of a line; the line is changed. */
static void split(char *line, void (*take)(int index, const char *text, void *into), void *into) {
  int index = 0;
  char *field = line, *end;
  line[strcspn(line, "\r\n")] = '\0';
  while ((end = strchr(field, ',')) != NULL) {
    *end = '\0';
    take(index++, field, into);
    field = end + 1;
  }
  take(index, field, into);
}

static void take_name(int index, const char *text, void *into) {
  columns *found = (columns *)into;
  if (strcmp(text, "t_device_s") == 0) {
    found->t = index;
  } else if (strcmp(text, "rate_dps") == 0) {
    found->rate = index;
  } else if (strcmp(text, "temp_c") == 0) {
    found->temp = index;
  }
}

typedef struct {
  columns at;
  double t_s, rate_dps, temp_c;
} sample;

static void take_value(int index, const char *text, void *into) {
  sample *measured = (sample *)into;
  const double value = *text == '\0' ? (double)NAN : strtod(text, NULL);
  if (index == measured->at.t) {
    measured->t_s = value;
  } else if (index == measured->at.rate) {
    measured->rate_dps = value;
  } else if (index == measured->at.temp) {
    measured->temp_c = value;
  }
}

int main(int count, char **words) {
  const int is_hdr = count > 1 && strcmp(words[1], "hdr") == 0;
  char line[LONGEST_LINE];
  sample measured = {{MISSING, MISSING, MISSING}, 0.0, 0.0, (double)NAN};
  gd_hdr hdr;
  gd_restlevel restlevel;
  gd_hdr_init(&hdr, &MY_GYRO_HDR);
  gd_restlevel_init(&restlevel, &MY_GYRO_RESTLEVEL);
  while (fgets(line, sizeof line, stdin) != NULL && line[0] == '#') {
  }
  split(line, take_name, &measured.at);
  if (measured.at.t == MISSING || measured.at.rate == MISSING) {
    fprintf(stderr, "the first line names no columns t_device_s and rate_dps\n");
    return 1;
  }
  printf(is_hdr ? "t_s,rate_dps,yaw_deg,bias_dps\n" : "t_s,rate_dps,yaw_deg,yaw_sigma_deg,bias_dps\n");
  while (fgets(line, sizeof line, stdin) != NULL) {
    double rate_dps;
    measured.t_s = measured.rate_dps = measured.temp_c = (double)NAN;
    split(line, take_value, &measured);
    rate_dps = gd_calibrated_dps(&MY_GYRO_CALIBRATION, measured.rate_dps, measured.temp_c);
    if (is_hdr && gd_hdr_update(&hdr, measured.t_s, rate_dps)) {
      printf("%.17g,%.17g,%.17g,%.17g\n", measured.t_s, rate_dps, hdr.yaw_deg, hdr.bias_dps);
    } else if (!is_hdr && gd_restlevel_update_with(&restlevel, measured.t_s, rate_dps, (double)NAN, measured.temp_c)) {
      printf("%.17g,%.17g,%.17g,%.17g,%.17g\n", measured.t_s, rate_dps, restlevel.yaw_deg, restlevel.yaw_sigma_deg,
             restlevel.bias_dps);
    }
  }
  return 0;
}
