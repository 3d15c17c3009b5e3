/* Attitude filter: merging and pruning of hypotheses, and the Gaussian sum as one estimate. */
#ifndef GD_ATTITUDE_MIXTURE_H
#define GD_ATTITUDE_MIXTURE_H

#include "attitude_hypotheses.h"

/* Probability below which a hypothesis is pruned. */
#define GD_ATTITUDE_LEAST_WEIGHT GD_R(1e-6)

/* The Gaussian sum as one estimate: mean heading by cubed weights, minus that of the most probable hypothesis, and its
   variance, rad; mean bias, rad/s, and its covariance; variance of the inclination, rad^2. */
typedef struct {
  gd_real heading, heading_var, bias[3], bias_cov[9], tilt_var;
} gd_attitude_moments;

static inline gd_real gd_attitude_variance(const gd_attitude_hypothesis *h, int state) {
  return h->cov[gd_place(state, state)];
}

/* Error states (21) from one hypothesis to another. */
static inline void gd_attitude_difference(gd_real error[GD_ATTITUDE_STATES], const gd_attitude_hypothesis *from,
                                          const gd_attitude_hypothesis *to) {
  int i;
  gd_vector_between(&error[GD_ATTITUDE_ATTITUDE], from->q, to->q);
  for (i = 0; i < 3; i++) {
    error[GD_ATTITUDE_BIAS + i] = to->bias[i] - from->bias[i];
    error[GD_ATTITUDE_VELOCITY + i] = to->velocity[i] - from->velocity[i];
    error[GD_ATTITUDE_FORCE_BIAS + i] = to->force_bias[i] - from->force_bias[i];
  }
  for (i = 0; i < 9; i++) {
    error[GD_ATTITUDE_SCALE + i] = to->scale[i] - from->scale[i];
  }
}

/* Whether two hypotheses agree in regime, in biases, and in headings, within the smaller standard deviation. */
static inline int gd_attitude_are_similar(const gd_attitude_hypothesis *g, const gd_attitude_hypothesis *h) {
  const gd_real same_rad = GD_SAME_YAW_DEG * GD_ATTITUDE_RAD;
  gd_real turn[3], heading_var, bias;
  int i;
  if (g->regime != h->regime || g->knows_bias != h->knows_bias || !(GD_ABS(g->yaw_deg - h->yaw_deg) < GD_R(180.0))) {
    return 0;
  }
  gd_vector_between(turn, g->q, h->q);
  heading_var = gd_min(gd_attitude_variance(g, GD_ATTITUDE_HEADING), gd_attitude_variance(h, GD_ATTITUDE_HEADING));
  if (!(turn[2] * turn[2] < heading_var + same_rad * same_rad)) {
    return 0;
  }
  for (i = 0; i < 3; i++) {
    bias = h->bias[i] - g->bias[i];
    if (!(bias * bias < gd_min(gd_attitude_variance(g, GD_ATTITUDE_BIAS + i),
                               gd_attitude_variance(h, GD_ATTITUDE_BIAS + i)))) {
      return 0;
    }
  }
  return 1;
}

/* Two hypotheses as one, by their moments, in the place of the first. */
static inline void gd_attitude_merge(gd_attitude_hypothesis *g, const gd_attitude_hypothesis *h) {
  const gd_real share = h->weight / (g->weight + h->weight);
  const gd_real yaw_deg = g->yaw_deg + share * (h->yaw_deg - g->yaw_deg);
  gd_real error[GD_ATTITUDE_STATES], *entry = g->cov;
  const gd_real *other = h->cov;
  int i, j;
  gd_attitude_difference(error, g, h);
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    for (j = i; j < GD_ATTITUDE_STATES; j++, entry++, other++) {
      *entry = (GD_R(1.0) - share) * *entry + share * *other + share * (GD_R(1.0) - share) * (error[i] * error[j]);
    }
  }
  for (i = 0; i < GD_ATTITUDE_STATES; i++) {
    error[i] *= share;
  }
  g->weight += h->weight;
  g->moving_s = gd_min(g->moving_s, h->moving_s);
  gd_attitude_correct(g, error);
  g->yaw_deg = yaw_deg;
}

/* Merge hypothesis `i` with the next one from `j` on that is similar; returns where the search goes on. */
static inline int gd_attitude_merge_with_later(gd_attitude_sum *sum, int i, int j) {
  for (; j < sum->count; j++) {
    gd_attitude_hypothesis *g = &sum->slot[sum->order[i]], *h = &sum->slot[sum->order[j]];
    if (gd_attitude_are_similar(g, h)) {
      gd_attitude_merge(g, h);
      gd_attitude_remove(sum, j);
      return j;
    }
  }
  return j;
}

/* Keep the most probable hypotheses, with probabilities that sum to 1. */
static inline void gd_attitude_prune(gd_attitude_sum *sum) {
  gd_attitude_normalize(sum);
  gd_attitude_sort(sum);
  if (sum->count > GD_ATTITUDE_HYPOTHESES) {
    sum->count = GD_ATTITUDE_HYPOTHESES;
  }
  while (sum->count > 1 && sum->slot[sum->order[sum->count - 1]].weight < GD_ATTITUDE_LEAST_WEIGHT) {
    sum->count = (uint8_t)(sum->count - 1);
  }
  gd_attitude_normalize(sum);
}

/* Mean heading and bias by cubed weights: the most probable hypothesis counts most. */
static inline void gd_attitude_means(gd_attitude_moments *m, const gd_attitude_sum *sum) {
  const gd_real first_deg = sum->slot[sum->order[0]].yaw_deg;
  gd_real total = 0, bias[3] = {0, 0, 0};
  int i, k;
  m->heading = 0;
  for (i = 0; i < sum->count; i++) {
    const gd_attitude_hypothesis *h = &sum->slot[sum->order[i]];
    const gd_real cube = h->weight * h->weight * h->weight;
    total += cube;
    m->heading += cube * ((h->yaw_deg - first_deg) * GD_ATTITUDE_RAD);
    for (k = 0; k < 3; k++) {
      bias[k] += cube * h->bias[k];
    }
  }
  m->heading /= total;
  for (k = 0; k < 3; k++) {
    m->bias[k] = bias[k] / total;
  }
}

/* The Gaussian sum as one estimate; the first hypothesis is the most probable. */
static inline void gd_attitude_moments_of(gd_attitude_moments *m, const gd_attitude_sum *sum) {
  const gd_attitude_hypothesis *first = &sum->slot[sum->order[0]];
  gd_real total = 0, heading_var = 0;
  int i, j, k;
  gd_attitude_means(m, sum);
  memset(m->bias_cov, 0, sizeof m->bias_cov);
  for (i = 0; i < sum->count; i++) {
    const gd_attitude_hypothesis *h = &sum->slot[sum->order[i]];
    const gd_real off = (h->yaw_deg - first->yaw_deg) * GD_ATTITUDE_RAD - m->heading;
    const gd_real weight = h->weight - GD_TAIL;
    if (!(weight > 0)) {
      continue;
    }
    total += weight;
    heading_var += weight * (gd_attitude_variance(h, GD_ATTITUDE_HEADING) + off * off);
    for (j = 0; j < 3; j++) {
      for (k = 0; k < 3; k++) {
        m->bias_cov[3 * j + k] += weight * (h->cov[gd_place(GD_ATTITUDE_BIAS + j, GD_ATTITUDE_BIAS + k)] +
                                            (h->bias[j] - m->bias[j]) * (h->bias[k] - m->bias[k]));
      }
    }
  }
  m->heading_var = heading_var / total;
  for (k = 0; k < 9; k++) {
    m->bias_cov[k] /= total;
  }
  m->tilt_var = GD_R(0.5) * (gd_attitude_variance(first, 0) + gd_attitude_variance(first, 1));
}

/* Bring the most probable hypothesis to the front. */
static inline void gd_attitude_bring_forward(gd_attitude_sum *sum) {
  int i, is_first = 1;
  for (i = 1; i < sum->count; i++) {
    is_first = is_first && sum->slot[sum->order[i]].weight <= sum->slot[sum->order[0]].weight;
  }
  if (!is_first) {
    gd_attitude_sort(sum);
  }
}

#endif
