/* A measurement of a second sensor, which waits for the end of a block. Twin of AidReading in aids/reading.py, without
   errors of the source: its heading is in the frame of yaw. */
#ifndef GD_AID_H
#define GD_AID_H

#include "real.h"

#define GD_WRONG_SHARE GD_R(0.1)   /* share of measurements that are wrong */
#define GD_WRONG_DPS GD_R(400.0)   /* range of biases that are wrong, deg/s */

typedef struct {
  gd_real value;      /* heading minus yaw, deg; or bias, deg/s */
  gd_real variance;   /* 0 without a measurement */
  gd_real period_deg; /* of a heading; 0 for a bias */
} gd_aid;

/* A measurement with this sigma; 0 if it is none, or its sigma is not above 0. */
static inline int gd_aid_set(gd_aid *aid, gd_real value, gd_real sigma, gd_real period_deg) {
  if (!(value - value >= GD_R(0.0)) || !(sigma > GD_R(0.0)) || !(sigma - sigma >= GD_R(0.0))) {
    return 0;
  }
  aid->value = value;
  aid->variance = sigma * sigma;
  aid->period_deg = period_deg;
  return 1;
}

/* A difference within half a period of 0. */
static inline gd_real gd_aid_wrap(const gd_aid *aid, gd_real difference) {
  const gd_real period = aid->period_deg;
  return period > GD_R(0.0) ? difference - period * GD_FLOOR(difference / period + GD_R(0.5)) : difference;
}

/* Density of a wrong value, with the share of such values. */
static inline gd_real gd_aid_wrong_density(const gd_aid *aid) {
  return GD_WRONG_SHARE / (aid->period_deg > GD_R(0.0) ? aid->period_deg : GD_WRONG_DPS);
}

/* Density of a normal distribution with mean 0. */
static inline gd_real gd_normal_pdf(gd_real x, gd_real variance) {
  return GD_EXP(GD_R(-0.5) * x * x / variance) / GD_SQRT(GD_R(2.0) * GD_PI * variance);
}

#endif
