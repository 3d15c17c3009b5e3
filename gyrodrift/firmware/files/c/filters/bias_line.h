/* Bias of an axis against temperature, measured by sure rests; for both filters. Twin of restlevel/temperature.py, and
   of the sure rests of restlevel/recall.py. */
#ifndef GD_BIAS_LINE_H
#define GD_BIAS_LINE_H

#include "real.h"

#define GD_UNSAID_C GD_R(-1000.0)     /* temperature before the first one */
#define GD_UNKNOWN_C GD_UNSAID_C
#define GD_COLDEST_C GD_R(-100.0)     /* temperatures out of this range are ignored */
#define GD_WARMEST_C GD_R(200.0)
#define GD_NEW_SLOPE_VAR GD_R(0.0001) /* of a new sensor, (deg/s per degree C)^2: 0.01^2 of common data sheets */
#define GD_HYSTERESIS_VAR_C GD_R(0.000225) /* variance about the line per degree C of change, (deg/s)^2 */
#define GD_POINT_S 10.0                    /* time of a sure rest between two measurements of the level */
#define GD_SMOOTH_S GD_R(3.0)              /* averaging time of the temperature */
#define GD_JUMP_SIGMAS GD_R(3.0)           /* distance from the line beyond which the bias has jumped */
#define GD_SURE_PROBABILITY GD_R(0.95)     /* probability of a sure rest, and its shortest length */
#define GD_SURE_S 10.0
#define GD_SURE_BY_WITNESS_S 1.5

/* Bias against temperature. */
typedef struct {
  gd_real temp_c, rest_c; /* averaged, and what it was at the last probable rest */
  gd_real slope_dps_c, slope_var;
  gd_real level_dps, level_var, covariance, level_c;
  double level_s;
  uint8_t points; /* measurements of the level, up to 255 */
} gd_bias_line;

/* Begins with the slope of a new sensor. */
static inline void gd_begin_line(gd_bias_line *line) {
  line->temp_c = line->rest_c = GD_UNKNOWN_C;
  line->slope_var = GD_NEW_SLOPE_VAR;
}

/* Whether a sensor may have this temperature; NaN is none. */
static inline int gd_is_temperature(gd_real temp_c) { return GD_COLDEST_C < temp_c && temp_c < GD_WARMEST_C; }

/* Follows the temperature over a block, which begins with this probability of rest. Returns the change of a bias in
   motion, deg/s, and sets the variance that it gains. */
static inline gd_real gd_follow_line(gd_bias_line *line, gd_real temp_c, gd_real rest_probability, gd_real seconds,
                                     gd_real *more_var) {
  const gd_real before_c = line->temp_c == GD_UNKNOWN_C ? temp_c : line->temp_c;
  gd_real step_c, away_c, was_away_c;
  line->temp_c = before_c + (temp_c - before_c) * gd_min(GD_R(1.0), seconds / GD_SMOOTH_S);
  if (rest_probability > GD_R(0.5) || line->rest_c == GD_UNKNOWN_C) {
    line->rest_c = before_c;
  }
  step_c = line->temp_c - before_c;
  away_c = line->temp_c - line->rest_c;
  was_away_c = before_c - line->rest_c;
  *more_var = line->slope_var * gd_max(GD_R(0.0), away_c * away_c - was_away_c * was_away_c) +
              GD_HYSTERESIS_VAR_C * GD_ABS(step_c);
  return line->slope_dps_c * step_c;
}

static inline void gd_predict_level(gd_bias_line *line, gd_real step_c, gd_real walk_var) {
  line->level_dps += line->slope_dps_c * step_c;
  line->level_var += step_c * (GD_R(2.0) * line->covariance + step_c * line->slope_var);
  line->level_var += GD_HYSTERESIS_VAR_C * GD_ABS(step_c) + walk_var;
  line->covariance += step_c * line->slope_var;
}

static inline void gd_update_level(gd_bias_line *line, gd_real innovation_dps, gd_real bias_var) {
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

/* Updates level and slope by the bias of a sure rest, its variance, and the time since the first sample. */
static inline void gd_measure_level(gd_bias_line *line, gd_real bias_dps, gd_real bias_var, double lived_s,
                                    gd_real rate_walk_var) {
  if (line->points == 0) {
    line->level_dps = bias_dps;
    line->level_var = bias_var;
    line->covariance = GD_R(0.0);
  } else {
    gd_predict_level(line, line->temp_c - line->level_c, rate_walk_var * (gd_real)(lived_s - line->level_s));
    gd_update_level(line, bias_dps - line->level_dps, bias_var);
  }
  if (line->points < UINT8_MAX) {
    ++line->points;
  }
  line->level_c = line->temp_c;
  line->level_s = lived_s;
}

/* Counts the length of a probable rest; returns whether it is sure. `is_certain` states that a rest sensor confirms
   it. */
static inline int gd_note_sure_rest(double *sure_s, gd_real rest_probability, double seconds, int is_certain) {
  if (rest_probability < GD_SURE_PROBABILITY) {
    *sure_s = 0.0;
    return 0;
  }
  *sure_s += seconds;
  return *sure_s >= (is_certain ? GD_SURE_BY_WITNESS_S : GD_SURE_S);
}

/* Whether the last block of a sure rest ends ten seconds of it: then the level is measured. */
static inline int gd_ends_point(double sure_s, double seconds) {
  return floor(sure_s / GD_POINT_S) > floor((sure_s - seconds) / GD_POINT_S);
}

#endif
