/* Restlevel: bias against temperature, measured by sure rests. Twin of restlevel/temperature.py, and of the sure rests
   of restlevel/recall.py. */
#ifndef GD_RESTLEVEL_TEMPERATURE_H
#define GD_RESTLEVEL_TEMPERATURE_H

#include "restlevel_model.h"

#if GD_RESTLEVEL_AUXILIARY

#define GD_HYSTERESIS_VAR_C GD_R(0.000225) /* variance about the line per degree C of change, (deg/s)^2 */
#define GD_POINT_S 10.0                    /* time of a sure rest between two measurements of the level */
#define GD_SMOOTH_S GD_R(3.0)              /* averaging time of the temperature */
#define GD_JUMP_SIGMAS GD_R(3.0)           /* distance from the line beyond which the bias has jumped */
#define GD_SURE_PROBABILITY GD_R(0.95)     /* probability of a sure rest, and its shortest length */
#define GD_SURE_S 10.0
#define GD_SURE_BY_WITNESS_S 1.5

/* Moves the bias of hypotheses in motion along the line, by the temperature at the end of the block. */
static inline void gd_rl_follow_temperature(gd_restlevel *s, gd_real temp_c, gd_real seconds) {
  gd_rl_line *line = &s->line;
  gd_real before_c, step_c, away_c, was_away_c, more_var;
  uint8_t k;
  if (temp_c == GD_UNKNOWN_C) {
    return;
  }
  before_c = line->temp_c == GD_UNKNOWN_C ? temp_c : line->temp_c;
  line->temp_c = before_c + (temp_c - before_c) * gd_min(GD_R(1.0), seconds / GD_SMOOTH_S);
  if (s->rest_probability > GD_R(0.5) || line->rest_c == GD_UNKNOWN_C) {
    line->rest_c = before_c;
  }
  step_c = line->temp_c - before_c;
  away_c = line->temp_c - line->rest_c;
  was_away_c = before_c - line->rest_c;
  more_var = line->slope_var * gd_max(GD_R(0.0), away_c * away_c - was_away_c * was_away_c) +
             GD_HYSTERESIS_VAR_C * GD_ABS(step_c);
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    if (h->weight > GD_R(0.0) && h->knows_bias && !h->is_at_rest) {
      h->bias_dps += line->slope_dps_c * step_c;
      h->bias_var += more_var;
    }
  }
}

static inline void gd_rl_predict_level(gd_rl_line *line, gd_real step_c, gd_real walk_var) {
  line->level_dps += line->slope_dps_c * step_c;
  line->level_var += step_c * (GD_R(2.0) * line->covariance + step_c * line->slope_var);
  line->level_var += GD_HYSTERESIS_VAR_C * GD_ABS(step_c) + walk_var;
  line->covariance += step_c * line->slope_var;
}

static inline void gd_rl_update_level(gd_rl_line *line, gd_real innovation_dps, gd_real bias_var) {
  const gd_real square = innovation_dps * innovation_dps;
  gd_real gain, slope_gain;
  if (square > GD_JUMP_SIGMAS * GD_JUMP_SIGMAS * (line->level_var + bias_var)) {
    line->level_var += square;
  }
  gain = line->level_var / (line->level_var + bias_var);
  slope_gain = line->covariance / (line->level_var + bias_var);
  line->level_dps += gain * innovation_dps;
  line->slope_dps_c += slope_gain * innovation_dps;
  line->slope_var -= slope_gain * line->covariance;
  line->level_var *= GD_R(1.0) - gain;
  line->covariance *= GD_R(1.0) - gain;
}

/* Updates level and slope by the bias of a sure rest. */
static inline void gd_rl_measure_level(gd_restlevel *s) {
  gd_rl_line *line = &s->line;
  if (line->points == 0) {
    line->level_dps = s->bias_dps;
    line->level_var = s->moments.bias_var;
    line->covariance = GD_R(0.0);
  } else {
    gd_rl_predict_level(line, line->temp_c - line->level_c,
                        s->c.rate_walk_var * (gd_real)(s->lived_s - line->level_s));
    gd_rl_update_level(line, s->bias_dps - line->level_dps, s->moments.bias_var);
  }
  if (line->points < UINT8_MAX) {
    ++line->points;
  }
  line->level_c = line->temp_c;
  line->level_s = s->lived_s;
}

/* Counts the length of a probable rest; returns whether it is sure. */
static inline int gd_rl_note_sure_rest(gd_restlevel *s, int is_certain) {
  if (s->rest_probability < GD_SURE_PROBABILITY) {
    s->sure_s = 0.0;
    return 0;
  }
  s->sure_s += s->block.seconds;
  return s->sure_s >= (is_certain ? GD_SURE_BY_WITNESS_S : GD_SURE_S);
}

/* Measures the level every ten seconds of a sure rest; `is_certain` states that a rest sensor confirms the rest. */
static inline void gd_rl_learn_when_sure(gd_restlevel *s, int is_certain) {
  if (!gd_rl_note_sure_rest(s, is_certain) || s->line.temp_c == GD_UNKNOWN_C) {
    return;
  }
  if (floor(s->sure_s / GD_POINT_S) > floor((s->sure_s - s->block.seconds) / GD_POINT_S)) {
    gd_rl_measure_level(s);
  }
}

#endif

#endif
