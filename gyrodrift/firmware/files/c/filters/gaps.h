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

typedef struct {
  double longest_step_s;      /* longest step that is no gap; 0 if the next step is one whatever its length */
  gd_real told_s;             /* length of the next gap if the times do not show it */
  uint32_t gaps, restarts;    /* gaps, and those after which the bias is in doubt */
  uint8_t has_restarted;      /* the device has restarted before the next sample */
} gd_gap_watch;

static inline double gd_longest_step_s(double period_s) {
  const double longest_s = GD_GAP_PERIODS * period_s;
  if (longest_s < GD_LONGEST_STEP_S) {
    return GD_LONGEST_STEP_S;
  }
  return longest_s < GD_MOST_STEP_S ? longest_s : GD_MOST_STEP_S;
}

/* Length of a gap: the step of the times, or what was told if that is a usual step. */
static inline gd_real gd_gap_length_s(const gd_gap_watch *watch, double step_s) {
  return step_s > GD_LONGEST_STEP_S ? (gd_real)step_s : gd_max((gd_real)step_s, watch->told_s);
}

/* Variance of yaw that is held over a gap, deg^2; `rates_dps` is the sum of the rates before and after it. */
static inline gd_real gd_turn_var(gd_real seconds, gd_real rates_dps) {
  const gd_real decay = GD_EXP(-seconds / GD_CORRELATION_S);
  const gd_real lag_s = GD_CORRELATION_S * (GD_R(1.0) - decay) / (GD_R(1.0) + decay);
  const gd_real turn_deg = gd_max(GD_R(-1e15), gd_min(lag_s * rates_dps, GD_R(1e15))); /* its square is finite */
  const gd_real drift_var = GD_R(2.0) * GD_RATE_DPS * GD_RATE_DPS * GD_CORRELATION_S * (seconds - GD_R(2.0) * lag_s);
  return gd_min(GD_CIRCLE_VAR, drift_var + turn_deg * turn_deg);
}

/* Counts a gap; whether the device may have been switched off and on in it. */
static inline int gd_count_gap(gd_gap_watch *watch, double step_s) {
  const int may_have_restarted = watch->has_restarted || step_s >= GD_POWER_CYCLE_S;
  const double limit_s = watch->longest_step_s > GD_LONGEST_STEP_S ? watch->longest_step_s : GD_LONGEST_STEP_S;
  watch->longest_step_s = gd_longest_step_s(step_s < limit_s ? step_s : limit_s);
  watch->told_s = GD_R(0.0);
  watch->has_restarted = 0;
  gd_count(&watch->gaps);
  if (may_have_restarted) {
    gd_count(&watch->restarts);
  }
  return may_have_restarted;
}

/* Takes the next step as a gap of some seconds, whatever the times are; or as a restart, with any time. */
static inline void gd_expect_gap(gd_gap_watch *watch, gd_real seconds, int has_restarted) {
  watch->longest_step_s = 0.0;
  watch->told_s = gd_max(watch->told_s, seconds);
  watch->has_restarted = watch->has_restarted || has_restarted;
}

#endif
