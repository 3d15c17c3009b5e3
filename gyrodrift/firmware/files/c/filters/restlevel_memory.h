/* Restlevel: begins with the bias of an earlier run. Twin of `begun` in restlevel/memory.py, for the bias alone. */
#ifndef GD_RESTLEVEL_MEMORY_H
#define GD_RESTLEVEL_MEMORY_H

#include "restlevel.h"

#if GD_RESTLEVEL_MEMORY

#define GD_REMEMBERED_WEIGHT GD_R(0.95)      /* probability that nothing has happened to the sensor */
#define GD_START_SHARE GD_R(0.1)             /* change by a restart, in sigmas of the turn-on bias */
#define GD_START_AGE_S GD_R(600.0)           /* age from which on a restart is certain */
#define GD_LEAST_REMEMBERED_VAR GD_R(1e-8)   /* LEAST_VAR of memory.py, (deg/s)^2 */
#define GD_MOST_REMEMBERED_DPS GD_R(1e5)
#define GD_MOST_REMEMBERED_SIGMA GD_R(1e6)

/* Probability that the sensor subtracts its own bias at each start, from the size of the remembered bias. */
static inline gd_real gd_rl_self_nulling(const gd_restlevel *s, gd_real bias_dps, gd_real seen_var) {
  gd_real well = GD_R(0.0), total = GD_R(0.0);
  uint8_t k;
  if (s->c.turn_on_var == GD_R(0.0)) {
    return GD_R(0.0);
  }
  for (k = 0; k < GD_PARTS; ++k) {
    const gd_real logpdf = gd_rl_gaussian_logpdf(bias_dps, gd_rl_part_var(s, k) + seen_var);
    const gd_real density = gd_part_share(k) * GD_EXP(logpdf);
    well = k == 0 ? density : well;
    total += density;
  }
  return well / gd_max(total, GD_LEAST_REMEMBERED_VAR);
}

/* Begins with the bias of an earlier run, kept in EEPROM or flash: its value, its sigma, and its age in s. Call it
   after init, before the first sample. Where the age is unknown, a day is a good guess.

   Returns 0 if a value is not finite or out of its limits, or if there was a sample. */
static inline int gd_restlevel_remember(gd_restlevel *s, gd_real bias_dps, gd_real bias_sigma_dps, gd_real age_s) {
  const gd_real new_start = gd_min(GD_R(1.0), age_s / GD_START_AGE_S);
  const gd_real seen_var = bias_sigma_dps * bias_sigma_dps;
  const gd_real walk_var = gd_min(s->c.rate_walk_var * age_s, s->c.turn_on_var);
  gd_real self_nulling;
  const gd_real start_var = GD_START_SHARE * GD_START_SHARE * s->c.turn_on_var * new_start;
  if (!(GD_ABS(bias_dps) <= GD_MOST_REMEMBERED_DPS && bias_sigma_dps >= GD_R(0.0) &&
        bias_sigma_dps <= GD_MOST_REMEMBERED_SIGMA && age_s >= GD_R(0.0) && age_s <= GD_R(GD_MOST_S)) ||
      s->samples > 0) {
    return 0;
  }
  s->remembered.bias_dps = bias_dps;
  s->remembered.bias_var = seen_var + (GD_LEAST_REMEMBERED_VAR + (walk_var + start_var));
  self_nulling = gd_rl_self_nulling(s, bias_dps, seen_var + GD_LEAST_REMEMBERED_VAR);
  s->remembered.weight = GD_REMEMBERED_WEIGHT * (GD_R(1.0) - new_start * self_nulling);
  return 1;
}

#endif

#endif
