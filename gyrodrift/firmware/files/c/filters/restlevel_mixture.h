/* Restlevel: merging, pruning and collapsing the Gaussian sum. Twin of restlevel/mixture.py. */
#ifndef GD_RESTLEVEL_MIXTURE_H
#define GD_RESTLEVEL_MIXTURE_H

#include "restlevel_kalman.h"

#define GD_MIN_WEIGHT GD_R(1e-9)
#define GD_TURN_ON_FACTOR GD_R(4.0) /* a larger ratio of turn-on variances is two kinds of parts */

/* Hypotheses in the order of their slots, twice as many as are kept. */
typedef struct {
  gd_rl_hypothesis *items[2 * GD_RL_STORED];
  uint8_t count;
} gd_rl_list;

static inline void gd_rl_normalise_list(gd_rl_list *list) {
  gd_real total = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < list->count; ++k) {
    total += list->items[k]->weight;
  }
  for (k = 0; k < list->count; ++k) {
    list->items[k]->weight /= total;
  }
}

/* Divides the probabilities by their sum. */
static inline void gd_rl_normalise(gd_restlevel *s) {
  gd_real total = GD_R(0.0);
  uint8_t k;
  for (k = 0; k < s->stored; ++k) {
    total += s->hypotheses[k].weight;
  }
  for (k = 0; k < s->stored; ++k) {
    s->hypotheses[k].weight /= total;
  }
}

/* Whether two hypotheses agree on rest, and differ in yaw and bias by less than the smaller sigma. */
static inline int gd_rl_is_in_merge_gate(const gd_rl_hypothesis *h, const gd_rl_hypothesis *other) {
  gd_real least_var, apart_dps, apart_deg;
  if (h->weight == GD_R(0.0) || other->weight == GD_R(0.0)) {
    return 0;
  }
  if (h->is_at_rest != other->is_at_rest || h->knows_bias != other->knows_bias) {
    return 0;
  }
  least_var = gd_min(h->bias_var, other->bias_var);
  if (!h->knows_bias && gd_max(h->bias_var, other->bias_var) > GD_TURN_ON_FACTOR * least_var) {
    return 0;
  }
  apart_dps = h->bias_dps - other->bias_dps;
  apart_deg = h->yaw_deg - other->yaw_deg;
  return apart_dps * apart_dps < least_var &&
         apart_deg * apart_deg < GD_SAME_YAW_DEG * GD_SAME_YAW_DEG + gd_min(h->yaw_var, other->yaw_var);
}

/* Merges the second into the first: mean and covariance of both together. */
static inline void gd_rl_moment_matched_merge(gd_rl_hypothesis *h, gd_rl_hypothesis *other) {
  const gd_real share = other->weight / (h->weight + other->weight);
  const gd_real apart_dps = other->bias_dps - h->bias_dps, apart_deg = other->yaw_deg - h->yaw_deg;
  const gd_real spread = share * (GD_R(1.0) - share);
  h->bias_var += share * (other->bias_var - h->bias_var) + spread * apart_dps * apart_dps;
  h->covariance += share * (other->covariance - h->covariance) + spread * apart_dps * apart_deg;
  h->yaw_var += share * (other->yaw_var - h->yaw_var) + spread * apart_deg * apart_deg;
  h->bias_dps += share * apart_dps;
  h->yaw_deg += share * apart_deg;
  h->moving_s = gd_min(h->moving_s, other->moving_s);
  h->rest_odds += share * (other->rest_odds - h->rest_odds);
  h->chance_density += share * (other->chance_density - h->chance_density);
  h->noisy_density += share * (other->noisy_density - h->noisy_density);
  h->odds += share * (other->odds - h->odds);
  h->turn_density += share * (other->turn_density - h->turn_density);
  h->weight += other->weight;
  other->weight = GD_R(0.0);
}

/* Prunes improbable hypotheses; returns the number of the others. */
static inline uint8_t gd_rl_forget_improbable(gd_rl_list *list) {
  uint8_t k, alive = 0;
  for (k = 0; k < list->count; ++k) {
    if (list->items[k]->weight < GD_MIN_WEIGHT) {
      list->items[k]->weight = GD_R(0.0);
    }
    alive = (uint8_t)(alive + (list->items[k]->weight > GD_R(0.0)));
  }
  return alive;
}

static inline void gd_rl_forget_least(gd_rl_list *list) {
  gd_rl_hypothesis *least = NULL;
  uint8_t k;
  for (k = 0; k < list->count; ++k) {
    gd_rl_hypothesis *h = list->items[k];
    if (h->weight > GD_R(0.0) && (least == NULL || h->weight < least->weight)) {
      least = h;
    }
  }
  if (least != NULL) {
    least->weight = GD_R(0.0);
  }
}

/* Merges a hypothesis with the next one from `j` on that agrees with it; returns the one after that. */
static inline uint8_t gd_rl_merge_with_later(gd_rl_list *list, uint8_t k, uint8_t j) {
  for (; j < list->count; ++j) {
    if (gd_rl_is_in_merge_gate(list->items[k], list->items[j])) {
      gd_rl_moment_matched_merge(list->items[k], list->items[j]);
      return (uint8_t)(j + 1);
    }
  }
  return j;
}

/* Prunes the least probable hypotheses. They stay in the list. */
static inline void gd_rl_prune_list(gd_rl_list *list) {
  uint8_t alive;
  for (alive = gd_rl_forget_improbable(list); alive > GD_MAX_HYPOTHESES; --alive) {
    gd_rl_forget_least(list);
  }
  gd_rl_normalise_list(list);
}

/* Closes the gaps of hypotheses without weight. */
static inline void gd_rl_close_gaps(gd_restlevel *s) {
  uint8_t k, kept = 0;
  for (k = 0; k < s->stored; ++k) {
    if (s->hypotheses[k].weight > GD_R(0.0)) {
      if (kept < k) {
        s->hypotheses[kept] = s->hypotheses[k];
      }
      ++kept;
    }
  }
  s->stored = kept;
}

#endif
