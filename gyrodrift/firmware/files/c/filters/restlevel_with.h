/* Restlevel with an external rest sensor and the temperature of the gyro. */
#ifndef GD_RESTLEVEL_WITH_H
#define GD_RESTLEVEL_WITH_H

#include "restlevel.h"

#if GD_RESTLEVEL_AUXILIARY

static inline void gd_rl_advance_with(gd_restlevel *s, double dt_s, gd_real rate_dps, gd_real still, gd_real temp_c) {
  gd_rl_hear(&s->witness, still);
  if (GD_COLDEST_C < temp_c && temp_c < GD_WARMEST_C) {
    s->temp_c = temp_c;
  }
  gd_rl_advance(s, s->samples > 0 ? dt_s : 0.0, rate_dps);
}

/* Takes a sample like gd_restlevel_update. `still` is 1 if an external sensor reports rest, and 0 if it reports motion;
   `temp_c` is the temperature of the gyro. NaN if unknown. */
static inline int gd_restlevel_update_with(gd_restlevel *s, double t_s, gd_real rate_dps, gd_real still,
                                           gd_real temp_c) {
  double dt_s = t_s - s->t_s;
  if (!gd_rl_accepts(s, t_s, &dt_s, rate_dps)) {
    return 0;
  }
  s->t_s = t_s;
  gd_rl_advance_with(s, dt_s, rate_dps, still, temp_c);
  return 1;
}

/* The same by a clock of microseconds that wraps. */
static inline int gd_restlevel_update_us_with(gd_restlevel *s, uint32_t t_us, gd_real rate_dps, gd_real still,
                                              gd_real temp_c) {
  double dt_s;
  if (!gd_rl_accepts_us(s, t_us, &dt_s, rate_dps)) {
    return 0;
  }
  gd_rl_advance_with(s, dt_s, rate_dps, still, temp_c);
  return 1;
}

#endif

#endif
