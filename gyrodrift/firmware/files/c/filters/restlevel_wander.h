/* Restlevel: probability that levels of stationary blocks wander, as in a motion. Twin of restlevel/wander.py. */
#ifndef GD_RESTLEVEL_WANDER_H
#define GD_RESTLEVEL_WANDER_H

#include "restlevel_model.h"

/* Probability that the next stationary block leaves the level: of a sensor, and of wandering levels. */
#define GD_SENSOR_BREAK GD_R(0.02)
#define GD_WANDER_BREAK GD_R(0.2)
#define GD_BREAK_LOG_ODDS GD_R(2.302585092994046)      /* log(0.2 / 0.02) */
#define GD_AGREEMENT_LOG_ODDS GD_R(0.2029408439966902) /* log(0.98 / 0.8) */
#define GD_WANDER_ODDS GD_R(0.1111111111111111)        /* prior odds that levels wander */
#define GD_FORGETTING GD_R(0.98)                       /* share of the log odds that a further block leaves */
#define GD_UNKNOWN_STEP_DPS GD_R(10.0)                 /* median step before the first step */
#define GD_STEP_GAIN GD_R(0.1)

/* Counts a stationary block that follows a stationary block and agrees with its level. */
static inline void gd_rl_count_agreement(gd_rl_wander *wander) {
  wander->log_odds = GD_FORGETTING * wander->log_odds - GD_AGREEMENT_LOG_ODDS;
}

/* Counts a stationary block that follows a stationary block and leaves its level by a step. */
static inline void gd_rl_count_break(gd_rl_wander *wander, gd_real step_dps) {
  gd_real gain;
  wander->log_odds = GD_FORGETTING * wander->log_odds + GD_BREAK_LOG_ODDS;
  if (wander->steps < UINT8_MAX) {
    ++wander->steps;
  }
  gain = gd_max(GD_STEP_GAIN, GD_R(1.0) / (gd_real)wander->steps);
  wander->step_dps *= GD_EXP(GD_ABS(step_dps) > wander->step_dps ? gain : -gain);
}

/* Forgets all levels: the blocks so far were motion. */
static inline void gd_rl_forget_levels(gd_rl_wander *wander) {
  wander->log_odds = GD_R(0.0);
  wander->steps = 0;
  wander->step_dps = GD_UNKNOWN_STEP_DPS;
}

static inline gd_real gd_rl_wander_probability(const gd_rl_wander *wander) {
  return GD_R(1.0) / (GD_R(1.0) + GD_EXP(-wander->log_odds) / GD_WANDER_ODDS);
}

#endif
