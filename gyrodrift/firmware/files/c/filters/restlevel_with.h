/* Restlevel with an external rest sensor, the temperature of the gyro, and a second sensor of yaw. */
#ifndef GD_RESTLEVEL_WITH_H
#define GD_RESTLEVEL_WITH_H

#include "restlevel.h"

#if GD_RESTLEVEL_AUXILIARY

static inline void gd_rl_advance_with(gd_restlevel *s, double dt_s, gd_real rate_dps, gd_real still, gd_real temp_c) {
  gd_rl_hear(&s->witness, still);
  if (gd_is_temperature(temp_c)) {
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

#if GD_RESTLEVEL_AIDS

/* Takes a heading of another sensor at the end of the block, deg, in the frame of `yaw_deg`. `period_deg` is 360, or 90
   for one of the directions of a building. Give one a second at most: more do not count as independent. Returns 0 if it
   is no number. */
static inline int gd_restlevel_heading(gd_restlevel *s, gd_real heading_deg, gd_real sigma_deg, gd_real period_deg) {
  gd_rl_catch_up(s);
  gd_rl_set_yaw(s);
  return period_deg > GD_R(0.0) && gd_aid_set(&s->aid, heading_deg - s->yaw_deg, sigma_deg, period_deg);
}

/* Takes a turn rate of another sensor at the last sample, deg/s, as wheels that go straight. */
static inline int gd_restlevel_turn_rate(gd_restlevel *s, gd_real turn_dps, gd_real sigma_dps) {
  gd_rl_catch_up(s);
  gd_rl_set_yaw(s);
  return gd_aid_set(&s->aid, s->rate_dps - turn_dps, sigma_dps, GD_R(0.0));
}

#endif

#endif
