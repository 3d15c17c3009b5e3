/* Restlevel: begins with the bias of an earlier run. */
#ifndef GD_RESTLEVEL_MEMORY_H
#define GD_RESTLEVEL_MEMORY_H

#include "bias_memory.h"
#include "restlevel.h"

#if GD_RESTLEVEL_MEMORY

/* Begins with the bias of an earlier run, kept in EEPROM or flash: its value, its sigma, and its age in s. Call it
   after init, before the first sample. Where the age is unknown, a day is a good guess.

   Returns 0 if a value is not finite or out of its limits, or if there was a sample. */
static inline int gd_restlevel_remember(gd_restlevel *s, gd_real bias_dps, gd_real bias_sigma_dps, gd_real age_s) {
  if (!gd_is_memory(bias_dps, bias_sigma_dps, age_s, GD_R(GD_MOST_S)) || s->samples > 0) {
    return 0;
  }
  s->remembered.bias_dps = bias_dps;
  s->remembered.bias_var = gd_remembered_var(bias_sigma_dps, age_s, s->c.rate_walk_var, s->c.turn_on_var);
  s->remembered.weight = gd_remembered_weight(&bias_dps, &bias_sigma_dps, 1, age_s, s->c.turn_on_var);
  return 1;
}

#endif

#endif
