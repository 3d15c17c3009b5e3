/* Attitude filter: restart of the yaw sigma. Twin of attitude/zero.py. */
#ifndef GD_ATTITUDE_ZERO_H
#define GD_ATTITUDE_ZERO_H

#include "attitude.h"

/* Restarts the yaw sigma at the last sample: from here on it is that of the yaw turned since. `yaw_deg` stays. */
static inline void gd_attitude_zero(gd_attitude *a) {
  int i;
  gd_attitude_catch_up(a);
  for (i = 0; a->samples > 0 && i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    gd_real turn[3] = {0, 0, 0};
    turn[GD_ATTITUDE_HEADING] = (a->start_deg - h->yaw_deg) * GD_ATTITUDE_RAD;
    gd_turn_by(h->q, turn);
    h->yaw_deg = a->start_deg;
    gd_reset_state(h->cov, GD_ATTITUDE_HEADING, GD_R(0.0));
  }
  if (a->samples > 0) {
    a->yaw_sigma_deg = GD_R(0.0);
  }
}

#endif
