/* Restlevel: odds of a rest against spins and motions, by scatter, length and end. Twin of restlevel/durations.py. */
#ifndef GD_RESTLEVEL_DURATIONS_H
#define GD_RESTLEVEL_DURATIONS_H

#include "restlevel_wander.h"

#define GD_CHANCE_LEVELS GD_R(4.0)  /* chance levels for each constant spin, if levels wander */
#define GD_CHANCE_STAYS GD_R(0.9)   /* probability that a chance level lasts for a further block */
#define GD_NOISY_STAYS GD_R(0.985)  /* or a noisy motion whose block means scatter less than white noise */
#define GD_GRADUAL_REST GD_R(0.01)  /* shares of rests, spins and chance levels that end gradually */
#define GD_GRADUAL_SPIN GD_R(0.1)
#define GD_GRADUAL_CHANCE GD_R(0.9)

static inline gd_real gd_rl_cauchy_pdf(gd_real x, gd_real squared_width) {
  const gd_real width = GD_SQRT(squared_width);
  return width / (GD_PI * (x * x + squared_width));
}

/* Density of spins that last so long, divided by the probability that a rest does. */
static inline gd_real gd_rl_spin_density(gd_real seconds) {
  return GD_SPINS_PER_DPS / gd_duration_odds(seconds);
}

static inline gd_real gd_rl_noisy_density(const gd_rl_hypothesis *h, gd_real sensor_odds) {
  return (GD_R(1.0) - sensor_odds) * h->noisy_density;
}

/* Sets the prior odds of a rest, and the densities of chance levels and noisy motions `away_dps` from the bias. */
static inline void gd_rl_begin_rest(gd_rl_hypothesis *h, const gd_rl_wander *wander, gd_real odds, gd_real sample_var,
                                    gd_real away_dps) {
  const gd_real by_chance = GD_CHANCE_LEVELS * gd_rl_wander_probability(wander);
  h->rest_odds = odds;
  h->odds = GD_R(1.0);
  h->chance_density = by_chance * gd_rl_cauchy_pdf(away_dps, wander->step_dps * wander->step_dps + h->bias_var);
  h->noisy_density = gd_max(GD_R(1.0), odds) * gd_rl_cauchy_pdf(away_dps, sample_var + h->bias_var);
}

/* Replaces the odds that the weight contains. */
static inline void gd_rl_weigh(gd_rl_hypothesis *h, gd_real odds) {
  h->weight *= odds / h->odds;
  h->odds = odds;
}

/* Weighs a rest by its scatter and its length. */
static inline void gd_rl_weigh_rest(gd_rl_hypothesis *h, gd_real seconds, gd_real sensor_odds) {
  const gd_real no_rest =
      gd_rl_spin_density(seconds) + h->chance_density + gd_rl_noisy_density(h, sensor_odds);
  gd_rl_weigh(h, h->rest_odds * sensor_odds / no_rest);
}

/* Multiplies the densities of motions by the probabilities that such a level lasts for a further block. */
static inline void gd_rl_outlast_motions(gd_rl_hypothesis *h, int averages_out) {
  h->chance_density *= GD_CHANCE_STAYS;
  if (averages_out) {
    h->noisy_density *= GD_NOISY_STAYS;
  }
}

/* Weighs a rest in vibration by its level and its length. */
static inline void gd_rl_weigh_vibrating_rest(gd_rl_hypothesis *h, gd_real seconds, gd_real level_density) {
  const gd_real no_rest = gd_rl_spin_density(seconds) + h->chance_density + h->noisy_density;
  gd_rl_weigh(h, h->rest_odds * level_density / no_rest);
}

/* Weighs a rest that has ended gradually. */
static inline void gd_rl_weigh_gradual_end(gd_rl_hypothesis *h, gd_real seconds, gd_real sensor_odds) {
  const gd_real by_motion = h->chance_density + gd_rl_noisy_density(h, sensor_odds);
  const gd_real no_rest = GD_GRADUAL_SPIN * gd_rl_spin_density(seconds) + GD_GRADUAL_CHANCE * by_motion;
  gd_rl_weigh(h, h->rest_odds * sensor_odds * GD_GRADUAL_REST / no_rest);
}

#endif
