/* Restlevel: the median of mean rates, which weighs the hypotheses without any rest. Twin of restlevel/turns.py. */
#ifndef GD_RESTLEVEL_TURNS_H
#define GD_RESTLEVEL_TURNS_H

#include "restlevel_durations.h"
#include "restlevel_mixture.h"

#define GD_TURN_S 10.0                   /* time of motion in a mean rate */
#define GD_LEAST_TURNS 5                 /* smallest number of mean rates for a median */
#define GD_CORRELATED_RATES GD_R(4.0)    /* consecutive mean rates that count as a single rate: bends last */
#define GD_LEAST_SPREAD_DPS GD_R(0.05)   /* smallest sigma of the median */
#define GD_SIDED GD_R(0.5)               /* share of devices that turn more to one side */

/* Mean rate at a rank, counted from 0, interpolated between two ordered values. */
static inline gd_real gd_rl_turn_at(const gd_rl_turns *turns, gd_real rank) {
  const uint8_t below = (uint8_t)rank;
  const gd_real low_dps = turns->latest_dps[turns->ordered[below]];
  const gd_real high_dps = turns->latest_dps[turns->ordered[below + 1]];
  return low_dps + (rank - (gd_real)below) * (high_dps - low_dps);
}

/* Removes the oldest mean rate from the order. */
static inline void gd_rl_forget_turn(gd_rl_turns *turns, uint8_t oldest) {
  uint8_t k = 0;
  while (k < GD_TURN_SLOTS - 1 && turns->ordered[k] != oldest) {
    ++k;
  }
  for (; k < GD_TURN_SLOTS - 1; ++k) {
    turns->ordered[k] = turns->ordered[k + 1];
  }
}

/* Updates the median by a mean rate. The number of n values below it is n/2, with a deviation of half the root of n. */
static inline void gd_rl_add_mean_rate(gd_rl_turns *turns, gd_real mean_dps) {
  const uint8_t index = turns->count % GD_TURN_SLOTS;
  const uint8_t others = turns->count < GD_TURN_SLOTS ? turns->count : GD_TURN_SLOTS - 1;
  gd_real middle, sigma, spread_dps;
  uint8_t k = others;
  if (turns->count >= GD_TURN_SLOTS) {
    gd_rl_forget_turn(turns, index);
  }
  while (k > 0 && turns->latest_dps[turns->ordered[k - 1]] > mean_dps) {
    turns->ordered[k] = turns->ordered[k - 1];
    --k;
  }
  turns->ordered[k] = index;
  turns->latest_dps[index] = mean_dps;
  turns->count = turns->count + 1 < 2 * GD_TURN_SLOTS ? (uint8_t)(turns->count + 1) : GD_TURN_SLOTS;
  if (turns->count < GD_LEAST_TURNS) {
    return;
  }
  middle = GD_R(0.5) * (gd_real)others;
  sigma = GD_R(0.5) * GD_SQRT((gd_real)others + GD_R(1.0));
  spread_dps = GD_R(0.5) * (gd_rl_turn_at(turns, middle + sigma) - gd_rl_turn_at(turns, middle - sigma));
  turns->median_dps = gd_rl_turn_at(turns, middle);
  turns->median_var = GD_CORRELATED_RATES * spread_dps * spread_dps + GD_LEAST_SPREAD_DPS * GD_LEAST_SPREAD_DPS;
}

/* Adds a block outside of constant-rate segments to the present mean rate. */
static inline void gd_rl_follow_turns(gd_rl_turns *turns, gd_real angle_deg, double seconds) {
  turns->angle_deg += angle_deg;
  turns->seconds += seconds;
  if (turns->seconds >= GD_TURN_S) {
    gd_rl_add_mean_rate(turns, turns->angle_deg / (gd_real)turns->seconds);
    turns->angle_deg = GD_R(0.0);
    turns->seconds = 0.0;
  }
}

static inline void gd_rl_forget_turns(gd_rl_turns *turns) {
  turns->seconds = 0.0;
  turns->angle_deg = GD_R(0.0);
  turns->count = 0;
}

/* Density of the median under a hypothesis, 1/(deg/s). */
static inline gd_real gd_rl_median_density(const gd_rl_turns *turns, const gd_rl_hypothesis *h) {
  const gd_real away_dps = turns->median_dps - h->bias_dps, variance = h->bias_var + turns->median_var;
  const gd_real both_sides =
      GD_EXP(GD_R(-0.5) * away_dps * away_dps / variance) / GD_SQRT(GD_R(2.0) * GD_PI * variance);
  return GD_SIDED * GD_SPINS_PER_DPS + (GD_R(1.0) - GD_SIDED) * both_sides;
}

/* Weighs a hypothesis by the distance of its bias from the median; this replaces the earlier weight. */
static inline void gd_rl_weigh_turns(const gd_rl_turns *turns, gd_rl_hypothesis *h) {
  const gd_real density = gd_rl_median_density(turns, h);
  h->weight *= density / h->turn_density;
  h->turn_density = density;
}

#endif
