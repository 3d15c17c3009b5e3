/* Attitude filter: rates of single samples that jump and return: a damaged transfer, not a turn. */
#ifndef GD_ATTITUDE_SPIKES_H
#define GD_ATTITUDE_SPIKES_H

#include "attitude_matrix.h"

/* Change of a rate between two samples that may be a spike, deg/s. */
#define GD_ATTITUDE_SPIKE_DPS GD_R(300.0)
/* Longest time between two samples of which the first may be a spike, s: slower streams turn by as much. */
#define GD_ATTITUDE_LONGEST_SPIKE_S GD_R(0.05)
/* Share of the jump within which the next sample has returned. */
#define GD_ATTITUDE_RETURN_SHARE GD_R(0.5)

/* Largest difference of two rates in an axis. */
static inline gd_real gd_attitude_largest_change(const gd_real a[3], const gd_real b[3]) {
  gd_real change[3];
  int i;
  for (i = 0; i < 3; i++) {
    change[i] = a[i] - b[i];
  }
  return gd_largest(change);
}

static inline void gd_attitude_middle(gd_real out[3], const gd_real a[3], const gd_real b[3]) {
  int i;
  for (i = 0; i < 3; i++) {
    out[i] = GD_R(0.5) * (a[i] + b[i]);
  }
}

/* Mean rate over dt up to this sample, deg/s; a suspect sample waits for the next one, and counts then or never. */
static inline void gd_attitude_mean_rate(gd_real out[3], gd_attitude *a, gd_real dt, const gd_real gyro[3]) {
  gd_real before[3], share;
  const gd_real jump = gd_attitude_largest_change(gyro, a->gyro_dps);
  int i;
  memcpy(before, a->gyro_dps, sizeof before);
  if (!(a->suspect_s > 0)) {
    if (jump < GD_ATTITUDE_SPIKE_DPS || dt > GD_ATTITUDE_LONGEST_SPIKE_S) {
      memcpy(a->gyro_dps, gyro, sizeof before);
      gd_attitude_middle(out, before, gyro);
      return;
    }
    memcpy(a->suspect_dps, gyro, sizeof before);
    a->suspect_s = dt;
    memcpy(out, before, sizeof before);
    return;
  }
  share = GD_R(0.5) * a->suspect_s / dt;
  memcpy(a->gyro_dps, gyro, sizeof before);
  a->suspect_s = 0;
  if (jump < GD_ATTITUDE_RETURN_SHARE * gd_attitude_largest_change(a->suspect_dps, before)) {
    gd_attitude_middle(out, before, gyro);
    return;
  }
  gd_attitude_middle(out, a->suspect_dps, gyro);
  for (i = 0; i < 3; i++) {
    out[i] += share * (a->suspect_dps[i] - before[i]);
  }
}

#endif
