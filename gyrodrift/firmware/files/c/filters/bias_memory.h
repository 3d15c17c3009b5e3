/* Biases of an earlier run, for both filters. Twin of `begun` in restlevel/memory.py, for the biases alone. */
#ifndef GD_BIAS_MEMORY_H
#define GD_BIAS_MEMORY_H

#include "beliefs.h"

#define GD_REMEMBERED_WEIGHT GD_R(0.95)      /* probability that nothing has happened to the sensor */
#define GD_START_SHARE GD_R(0.1)             /* change by a restart, in sigmas of the turn-on bias */
#define GD_START_AGE_S GD_R(600.0)           /* age from which on a restart is certain */
#define GD_LEAST_REMEMBERED_VAR GD_R(1e-8)   /* LEAST_VAR of memory.py, (deg/s)^2 */
#define GD_MOST_REMEMBERED_DPS GD_R(1e5)
#define GD_MOST_REMEMBERED_SIGMA GD_R(1e6)

/* Whether a bias, its sigma and its age can be remembered. */
static inline int gd_is_memory(gd_real bias_dps, gd_real bias_sigma_dps, gd_real age_s, gd_real most_s) {
  return GD_ABS(bias_dps) <= GD_MOST_REMEMBERED_DPS && bias_sigma_dps >= GD_R(0.0) &&
         bias_sigma_dps <= GD_MOST_REMEMBERED_SIGMA && age_s >= GD_R(0.0) && age_s <= most_s;
}

/* Variance of a remembered bias now, by the random walk and by a restart of the sensor. */
static inline gd_real gd_remembered_var(gd_real bias_sigma_dps, gd_real age_s, gd_real rate_walk_var,
                                        gd_real turn_on_var) {
  const gd_real walk_var = gd_min(rate_walk_var * age_s, turn_on_var);
  const gd_real start_var = GD_START_SHARE * GD_START_SHARE * turn_on_var * gd_min(GD_R(1.0), age_s / GD_START_AGE_S);
  return bias_sigma_dps * bias_sigma_dps + (GD_LEAST_REMEMBERED_VAR + (walk_var + start_var));
}

/* Probability of the remembered biases of some axes. A sensor that subtracts its own bias at each start has another one
   after the next; the size of the biases shows that. */
static inline gd_real gd_remembered_weight(const gd_real *bias_dps, const gd_real *bias_sigma_dps, int axes,
                                           gd_real age_s, gd_real turn_on_var) {
  gd_real well = GD_R(0.0), total = GD_R(0.0);
  uint8_t part;
  int k;
  for (part = 0; part < GD_PARTS && turn_on_var > GD_R(0.0); ++part) {
    const gd_real part_var = turn_on_var * gd_part_wider(part) * gd_part_wider(part);
    gd_real logpdf = GD_R(0.0), density;
    for (k = 0; k < axes; k++) {
      const gd_real var = part_var + (bias_sigma_dps[k] * bias_sigma_dps[k] + GD_LEAST_REMEMBERED_VAR);
      logpdf -= GD_R(0.5) * (bias_dps[k] * bias_dps[k] / var + GD_LOG(GD_R(2.0) * GD_PI * var));
    }
    density = gd_part_share(part) * GD_EXP(logpdf);
    well = part == 0 ? density : well;
    total += density;
  }
  well /= gd_max(total, GD_LEAST_REMEMBERED_VAR);
  return GD_REMEMBERED_WEIGHT * (GD_R(1.0) - gd_min(GD_R(1.0), age_s / GD_START_AGE_S) * well);
}

#endif
