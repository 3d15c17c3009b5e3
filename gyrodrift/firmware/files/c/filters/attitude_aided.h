/* Attitude filter: measurements of heading and of the bias about the vertical by a second sensor. Twin of
   attitude/aided.py. */
#ifndef GD_ATTITUDE_AIDED_H
#define GD_ATTITUDE_AIDED_H

#include "aid.h"
#include "attitude_hypotheses.h"
#include "attitude_mixture.h"

/* Updates a hypothesis and its weight: the measurement is right or wrong. `axis` is the vertical in the sensor. */
static inline void gd_attitude_aid_update(gd_attitude_hypothesis *h, const gd_aid *aid, const gd_real axis[3],
                                          gd_real expected_deg) {
  const int is_heading = aid->period_deg > GD_R(0.0);
  const gd_real rad = GD_ATTITUDE_RAD;
  const gd_real expected = is_heading ? h->yaw_deg - expected_deg : gd_dot(h->bias, axis) / rad;
  const gd_real innovation = gd_aid_wrap(aid, aid->value - expected);
  gd_real carried[GD_ATTITUDE_STATES], error[GD_ATTITUDE_STATES], variance, density, likelihood, right, spread;
  gd_real *entry = h->cov;
  int i, j;
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    carried[i] = h->cov[gd_place(i, GD_ATTITUDE_HEADING)];
    if (!is_heading) {
      carried[i] = 0;
      for (j = 0; j < 3; j++) {
        carried[i] += axis[j] * h->cov[gd_place(i, GD_ATTITUDE_BIAS + j)];
      }
    }
  }
  variance = is_heading ? carried[GD_ATTITUDE_HEADING] : gd_dot(&carried[GD_ATTITUDE_BIAS], axis);
  variance = variance / (rad * rad) + aid->variance;
  density = gd_normal_pdf(innovation, variance);
  likelihood = (GD_R(1.0) - GD_WRONG_SHARE) * density + gd_aid_wrong_density(aid);
  right = (GD_R(1.0) - GD_WRONG_SHARE) * density / likelihood;
  spread = right * (variance - (GD_R(1.0) - right) * innovation * innovation) / (rad * rad);
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    carried[i] /= variance;
    error[i] = right * innovation * carried[i] / rad;
  }
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    for (j = i; j < GD_ATTITUDE_STATES; j++) {
      *entry++ -= spread * carried[i] * carried[j];
    }
  }
  gd_attitude_correct(h, error);
  h->weight *= likelihood;
}

/* Updates hypothesis `i` by the measurement that waits, at the end of a block with this heading by the estimates before
   it. */
static inline void gd_attitude_take_aid(gd_attitude *a, int i, gd_real expected_deg) {
  gd_real q[4], axis[3];
  gd_product(q, a->start_q, a->block.q);
  gd_heading_axis(axis, q);
  gd_attitude_aid_update(gd_attitude_at(a, i), &a->aid, axis, expected_deg);
}

#endif
