/* Attitude filter: the Gaussian sum: lists of hypotheses, their correction, and their order. */
#ifndef GD_ATTITUDE_HYPOTHESES_H
#define GD_ATTITUDE_HYPOTHESES_H

#include "attitude_quaternion.h"

/* Add error states (21) to the means. */
static inline void gd_attitude_correct(gd_attitude_hypothesis *h, const gd_real *error) {
  int i;
  gd_turn_by(h->q, &error[GD_ATTITUDE_ATTITUDE]);
  for (i = 0; i < 3; i++) {
    h->bias[i] += error[GD_ATTITUDE_BIAS + i];
    h->velocity[i] += error[GD_ATTITUDE_VELOCITY + i];
    h->force_bias[i] += error[GD_ATTITUDE_FORCE_BIAS + i];
  }
  for (i = 0; i < 9; i++) {
    h->scale[i] += error[GD_ATTITUDE_SCALE + i];
  }
  h->yaw_deg += error[GD_ATTITUDE_HEADING] / GD_ATTITUDE_RAD;
}

/* Start with a single hypothesis without uncertainty, level and at rest. */
static inline void gd_attitude_first_hypothesis(gd_attitude_sum *sum) {
  memset(sum, 0, sizeof *sum);
  sum->count = 1;
  sum->slot[0].weight = 1;
  gd_identity(sum->slot[0].q);
}

/* Slot that no hypothesis uses. */
static inline uint8_t gd_attitude_free_slot(const gd_attitude_sum *sum, const uint8_t *extra, int extras) {
  int slot, i, is_free = 0;
  for (slot = 0; slot < GD_ATTITUDE_SLOTS && !is_free; slot++) {
    is_free = 1;
    for (i = 0; i < sum->count; i++) {
      is_free = is_free && sum->order[i] != slot;
    }
    for (i = 0; i < extras; i++) {
      is_free = is_free && extra[i] != slot;
    }
  }
  return (uint8_t)(slot - 1);
}

/* Sort by falling probability; equal ones keep their order. */
static inline void gd_attitude_sort(gd_attitude_sum *sum) {
  int i, j;
  for (i = 1; i < sum->count; i++) {
    const uint8_t moved = sum->order[i];
    for (j = i; j > 0 && sum->slot[sum->order[j - 1]].weight < sum->slot[moved].weight; j--) {
      sum->order[j] = sum->order[j - 1];
    }
    sum->order[j] = moved;
  }
}

/* Scale the probabilities to a sum of 1. */
static inline void gd_attitude_normalize(gd_attitude_sum *sum) {
  gd_real total = 0;
  int i;
  for (i = 0; i < sum->count; i++) {
    total += sum->slot[sum->order[i]].weight;
  }
  for (i = 0; i < sum->count; i++) {
    sum->slot[sum->order[i]].weight /= total;
  }
}

/* Remove number i of the list. */
static inline void gd_attitude_remove(gd_attitude_sum *sum, int i) {
  sum->count = (uint8_t)(sum->count - 1);
  for (; i < sum->count; i++) {
    sum->order[i] = sum->order[i + 1];
  }
}

#endif
