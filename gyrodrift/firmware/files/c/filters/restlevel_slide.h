/* Restlevel: bias of a rest before it began to slide, restored after a gradual end. Twin of restlevel/slide.py. */
#ifndef GD_RESTLEVEL_SLIDE_H
#define GD_RESTLEVEL_SLIDE_H

#include "restlevel_model.h"

#define GD_SAME_TIME_S 1e-6     /* times that differ by less are the same */
#define GD_MARK_S 4.0           /* time between two recent values of the bias */
#define GD_FLAT_S GD_R(1.0)     /* a step up to the drift of this time is no slide */
#define GD_LONGEST_SLIDE_S 40.0 /* bends last no longer */

static inline void gd_rl_mark_bias(gd_rl_mark *mark, const gd_rl_hypothesis *h) {
  mark->bias_dps = h->bias_dps;
  mark->bias_var = h->bias_var;
  mark->ago_s = 0.0;
}

/* Stores the present bias as recent and as safe. */
static inline void gd_rl_mark_safe(gd_rl_hypothesis *h) {
  gd_rl_mark_bias(&h->recent, h);
  gd_rl_mark_bias(&h->safe, h);
  h->slide_dps = GD_R(0.0);
  h->has_been_flat = 0;
}

static inline gd_real gd_rl_towards_zero(gd_real x, gd_real step) {
  return x > step ? x - step : gd_min(x + step, GD_R(0.0));
}

/* Follows the slide of a rest after the zero-velocity update of a block; `ramp_dps_s` is the fastest drift. */
static inline void gd_rl_follow_slide(gd_real ramp_dps_s, gd_rl_hypothesis *h, double seconds) {
  gd_rl_mark *recent = &h->recent, *safe = &h->safe;
  const gd_real least_dps = ramp_dps_s * GD_FLAT_S, before_dps = h->slide_dps;
  gd_real step_dps;
  recent->ago_s += seconds;
  safe->ago_s += seconds;
  if (recent->ago_s < GD_MARK_S - GD_SAME_TIME_S) {
    return;
  }
  step_dps = h->bias_dps - recent->bias_dps;
  h->slide_dps = h->has_been_flat ? gd_rl_towards_zero(before_dps + step_dps, least_dps) : GD_R(0.0);
  h->has_been_flat = h->has_been_flat || GD_ABS(step_dps) <= least_dps + GD_SQRT(recent->bias_var);
  if (h->slide_dps * before_dps <= GD_R(0.0) || safe->ago_s >= GD_LONGEST_SLIDE_S) {
    *safe = *recent;
  }
  gd_rl_mark_bias(recent, h);
}

static inline void gd_rl_exchange(gd_rl_hypothesis *h) {
  const gd_real bias_dps = h->bias_dps, bias_var = h->bias_var;
  h->bias_dps = h->safe.bias_dps;
  h->bias_var = h->safe.bias_var;
  h->safe.bias_dps = bias_dps;
  h->safe.bias_var = bias_var;
}

/* Exchanges bias and safe bias of a rest that has ended gradually; yaw turns with the safe bias since the end. */
static inline void gd_rl_restore_safe_bias(gd_rl_hypothesis *h) {
  gd_rl_exchange(h);
  h->yaw_deg -= (h->bias_dps - h->safe.bias_dps) * h->moving_s;
  h->moving_s += (gd_real)h->safe.ago_s;
  h->checkpoint.moving_s += (gd_real)h->safe.ago_s;
}

/* Undoes `restore_safe_bias` if the rest resumes; yaw is the yaw at the beginning of the segment. */
static inline void gd_rl_undo_safe_bias(gd_rl_hypothesis *h) {
  gd_rl_exchange(h);
  h->moving_s -= (gd_real)h->safe.ago_s;
  h->yaw_deg -= (h->bias_dps - h->safe.bias_dps) * h->moving_s;
}

#endif
