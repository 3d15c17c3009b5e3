/* Restlevel: the bias follows the temperature. */
#ifndef GD_RESTLEVEL_TEMPERATURE_H
#define GD_RESTLEVEL_TEMPERATURE_H

#include "restlevel_model.h"

#if GD_RESTLEVEL_AUXILIARY

/* Moves the bias of hypotheses in motion along the line, by the temperature at the end of the block. */
static inline void gd_rl_follow_temperature(gd_restlevel *s, gd_real temp_c, gd_real seconds) {
  gd_real step_dps, more_var;
  uint8_t k;
  if (temp_c == GD_UNKNOWN_C) {
    return;
  }
  step_dps = gd_follow_line(&s->line, temp_c, s->rest_probability, seconds, &more_var);
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    if (h->weight > GD_R(0.0) && h->knows_bias && !h->is_at_rest) {
      h->bias_dps += step_dps;
      h->bias_var += more_var;
    }
  }
}

/* Measures the level every ten seconds of a sure rest; `is_certain` states that a rest sensor confirms the rest. */
static inline void gd_rl_learn_when_sure(gd_restlevel *s, int is_certain) {
  const int is_sure = gd_note_sure_rest(&s->sure_s, s->rest_probability, s->block.seconds, is_certain);
  if (is_sure && !(s->line.temp_c == GD_UNKNOWN_C) && gd_ends_point(s->sure_s, s->block.seconds)) {
    gd_measure_level(&s->line, s->bias_dps, s->moments.bias_var, s->lived_s, s->c.rate_walk_var);
  }
}

#endif

#endif
