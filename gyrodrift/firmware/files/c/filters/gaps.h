/* Gaps and restarts: meanwhile the motion of the device is unknown. Twin of gaps.py, which has the reasons. */
#ifndef GD_GAPS_H
#define GD_GAPS_H

#include "real.h"

#define GD_LONGEST_STEP_S 0.3    /* longest step that is no gap at any sample rate */
#define GD_GAP_PERIODS 3.0       /* periods of a slow device in a step that is no gap */
#define GD_MOST_STEP_S 3.0       /* longest step that is no gap of any device */
#define GD_FIRST_STEP_S 1.5      /* longest step that is no gap before the period is known */
#define GD_RATE_DPS GD_R(60.0)   /* standard deviation of the unknown rate, and its correlation time */
#define GD_CORRELATION_S GD_R(1.0)
#define GD_CIRCLE_VAR GD_R(10800.0) /* of a uniform angle, deg^2 */
#define GD_POWER_CYCLE_S 10.0       /* shortest gap in which a device may have been switched off and on */
#define GD_CORRECTION_DEG GD_R(1.0) /* step of yaw without motion above which it counts as a correction */
#define GD_UNKNOWN_S GD_R(1e9)      /* length of a gap that nobody knows */

#define GD_TOLD_GAP 0.0 /* longest step before a gap that is told, and before a restart */
#define GD_TOLD_RESTART (-1.0)

/* Longest step that is no gap of a device with this period. */
static inline double gd_longest_step_s(double period_s) {
  const double longest_s = GD_GAP_PERIODS * period_s;
  if (longest_s < GD_LONGEST_STEP_S) {
    return GD_LONGEST_STEP_S;
  }
  return longest_s < GD_MOST_STEP_S ? longest_s : GD_MOST_STEP_S;
}

/* Length of a gap: the step of the times, or unknown if that is a usual step. */
static inline gd_real gd_gap_length_s(double step_s) {
  return step_s > GD_LONGEST_STEP_S ? (gd_real)step_s : GD_UNKNOWN_S;
}

/* Variance of yaw that is held over a gap, deg^2; `rates_dps` is the sum of the rates before and after it. */
static inline gd_real gd_turn_var(gd_real seconds, gd_real rates_dps) {
  const gd_real decay = GD_EXP(-seconds / GD_CORRELATION_S);
  const gd_real lag_s = GD_CORRELATION_S * (GD_R(1.0) - decay) / (GD_R(1.0) + decay);
  const gd_real turn_deg = lag_s * rates_dps;
  const gd_real drift_var = GD_R(2.0) * GD_RATE_DPS * GD_RATE_DPS * GD_CORRELATION_S * (seconds - GD_R(2.0) * lag_s);
  return gd_min(GD_CIRCLE_VAR, drift_var + turn_deg * turn_deg);
}

/* Whether the device may have been switched off and on in a gap before which this was the longest step. */
static inline int gd_may_have_restarted(double longest_s, double step_s) {
  return longest_s < GD_TOLD_GAP || step_s >= GD_POWER_CYCLE_S;
}

/* Longest step after a gap: the device may send fewer samples from now on. */
static inline double gd_longest_after_gap_s(double longest_s, double step_s) {
  const double limit_s = longest_s > GD_LONGEST_STEP_S ? longest_s : GD_LONGEST_STEP_S;
  return gd_longest_step_s(step_s < limit_s ? step_s : limit_s);
}

#endif
