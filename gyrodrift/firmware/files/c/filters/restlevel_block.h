/* Restlevel: what a block leaves when all hypotheses are updated. Twin of `_end_block` in restlevel/step.py. */
#ifndef GD_RESTLEVEL_BLOCK_H
#define GD_RESTLEVEL_BLOCK_H

#include "restlevel_aided.h"
#include "restlevel_frozen.h"
#include "restlevel_output.h"
#include "restlevel_still.h"
#include "restlevel_temperature.h"

#define GD_RL_BASE_DEG GD_R(64.0) /* with floats, yaw of the hypotheses is kept below about this */

/* With floats, subtracts a whole multiple of 64 degrees from all yaws, so that a device that turns in one direction
   loses no digits. The multiples are exact. */
static inline void gd_rl_keep_near_zero(gd_restlevel *s) {
  const gd_real away_deg = GD_FLOOR(s->moments.yaw_deg / GD_RL_BASE_DEG) * GD_RL_BASE_DEG;
  uint8_t k;
  if (!GD_IS_FLOAT || GD_ABS(s->moments.yaw_deg) < GD_RL_BASE_DEG) {
    return;
  }
  s->base_deg += away_deg;
  s->moments.yaw_deg -= away_deg;
  s->start_yaw_deg -= away_deg;
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].yaw_deg -= away_deg;
    s->hypotheses[k].checkpoint.yaw_deg -= away_deg;
  }
}

/* Learns the temperature of a sure rest at the end of the block. */
static inline void gd_rl_end_auxiliary(gd_restlevel *s, int is_certain) {
#if GD_RESTLEVEL_AUXILIARY
  s->lived_s += s->block.seconds;
  gd_rl_learn_when_sure(s, is_certain);
  s->witness.was_certain = is_certain != 0;
#else
  (void)s, (void)is_certain;
#endif
}

/* 0 while all hypotheses are finite, else NaN. */
static inline gd_real gd_rl_probe(const gd_restlevel *s) {
  gd_real probe = s->moments.yaw_var - s->moments.yaw_var + (s->noise.angle_walk_var - s->noise.angle_walk_var);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    const gd_rl_hypothesis *h = &s->hypotheses[k];
    probe += (h->weight - h->weight) + (h->yaw_deg - h->yaw_deg) + (h->bias_dps - h->bias_dps);
    probe += (h->yaw_var - h->yaw_var) + (h->covariance - h->covariance) + (h->bias_var - h->bias_var);
  }
  return probe;
}

/* With floats, restarts from this yaw if a damaged sample has exceeded their range, as a rate of 1e12 deg/s can.
   Doubles have this range. */
static inline void gd_rl_recover(gd_restlevel *s, gd_real yaw_deg) {
  if (!GD_IS_FLOAT || gd_rl_probe(s) == GD_R(0.0)) {
    return;
  }
  s->moments.yaw_deg = yaw_deg;
  s->start_yaw_deg = yaw_deg;
  s->base_deg = s->travelled_deg = GD_R(0.0);
  s->segment.sensor_odds = GD_R(1.0);
  gd_rl_restart(s);
}

#endif
