/* What the filters of one axis and of three believe of parts, rests and turns. Twin of beliefs.py. */
#ifndef GD_BELIEFS_H
#define GD_BELIEFS_H

#include "real.h"

#define GD_PARTS 4                  /* kinds of parts by their bias at power-on */
#define GD_RAMP_PROBABILITY GD_R(0.3) /* probability of a ramp of the bias since the last rest */
#define GD_MAX_RAMP_S GD_R(20.0)    /* longest ramp of a bias since the last rest */
#define GD_SPINS_PER_DPS GD_R(0.03) /* density of the rates of constant turns, 1/(deg/s) */
#define GD_LEVEL_S GD_R(12.0)       /* scale of the lengths of rests and turns */
#define GD_TAIL GD_R(0.045)         /* subtracted from probabilities for the variances: two sigmas hold 19 in 20 */
#define GD_SAME_YAW_DEG GD_R(0.01)  /* difference of two yaws that are the same whatever their variances */
#define GD_MAJORITY GD_R(0.5)       /* probability above which a state of the device counts as true */

/* Share of a kind. */
static inline gd_real gd_part_share(uint8_t kind) {
  return kind < 2 ? GD_R(0.25) : kind == 2 ? GD_R(0.48) : GD_R(0.02);
}

/* Sigma of its bias over `turn_on_dps`: the first two subtract their own bias, the last is raw. */
static inline gd_real gd_part_wider(uint8_t kind) {
  return kind == 0 ? GD_R(0.01) : kind == 1 ? GD_R(0.1) : kind == 2 ? GD_R(1.0) : GD_R(8.0);
}

/* Variance that a bias has gained over a gap, by a random walk or a ramp; a walk gains at most `turn_on_var`. */
static inline gd_real gd_drift_var(gd_real seconds, gd_real walk_var, gd_real ramp_per_s, gd_real turn_on_var) {
  const gd_real ramp = ramp_per_s * gd_min(seconds, GD_MAX_RAMP_S);
  return gd_min(walk_var * seconds, turn_on_var) + GD_RAMP_PROBABILITY * ramp * ramp;
}

/* Odds of a rest against a turn by the time for which they have lasted, s. */
static inline gd_real gd_duration_odds(gd_real seconds) {
  return GD_SQRT(GD_SQRT(GD_R(1.0) + seconds * seconds / (GD_LEVEL_S * GD_LEVEL_S)));
}

#endif
