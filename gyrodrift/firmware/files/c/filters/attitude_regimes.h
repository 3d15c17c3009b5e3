/* Attitude filter: rest or even turn: the regimes of a segment in which gyro and accelerometer keep their means.

   Gravity stays constant in the sensor only in a rest and in an even turn about the vertical. The rates about the level
   axes are biases in both, and only the vertical component decides. Each hypothesis branches. Later segments and the
   velocity decide between the branches. */
#ifndef GD_ATTITUDE_REGIMES_H
#define GD_ATTITUDE_REGIMES_H

#include "attitude_evidence.h"
#include "attitude_measure.h"

/* Error of a rest's mean beside its scatter, and that of a noisy rest once a quiet one is measured, rad/s. */
#define GD_ATTITUDE_REST_BIAS (GD_R(0.045) * GD_ATTITUDE_RAD)
#define GD_ATTITUDE_NOISY_REST (GD_R(0.4) * GD_ATTITUDE_RAD)
/* Weight of the scatter of block means in the error of their mean. */
#define GD_ATTITUDE_SPREAD_WEIGHT GD_R(2.0)
/* Squared distance, of three components, beyond which a later window does not belong to the rest: 3 sigma each. */
#define GD_ATTITUDE_GATE GD_R(27.0)
/* Standard deviation of the velocity in quiet and in noisy rests, m/s. */
#define GD_ATTITUDE_QUIET_SPEED GD_R(0.05)
#define GD_ATTITUDE_NOISY_SPEED GD_R(0.1)
/* Standard deviation of the vertical rate of an even turn as a measurement of the bias, rad/s: none. */
#define GD_ATTITUDE_FREE_RATE (GD_R(1000.0) * GD_ATTITUDE_RAD)
/* Logarithm of odds from which on a hypothesis does not branch: 1 : 8000. */
#define GD_ATTITUDE_CERTAIN GD_R(9.0)
#define GD_ATTITUDE_LARGEST_LOG GD_R(60.0)

/* Unit vector of the vertical in the sensor: the mean acceleration, or the attitude without one. */
static inline void gd_attitude_vertical(gd_real up[3], const gd_attitude_hypothesis *h,
                                        const gd_attitude_candidate *m) {
  const gd_real norm = GD_SQRT(gd_dot(m->accel, m->accel));
  int i;
  if (norm > 0) {
    for (i = 0; i < 3; i++) {
      up[i] = m->accel[i] / norm;
    }
  } else {
    gd_up_in_sensor(up, h->q);
  }
}

/* Variances (3) of the mean rates of a candidate by the scatter of its blocks, (rad/s)^2. */
static inline void gd_attitude_scatter_variances(gd_real out[3], const gd_attitude_candidate *m) {
  const int is_quiet = m->kind.blocks <= GD_ATTITUDE_QUIET_BLOCKS;
  const gd_real share = GD_ATTITUDE_SPREAD_WEIGHT / (gd_real)m->kind.blocks * (is_quiet ? GD_R(2.0) : GD_R(5.0));
  int i;
  for (i = 0; i < 3; i++) {
    out[i] = m->gyro_var[i] * share;
  }
}

/* The same as a bias. */
static inline void gd_attitude_mean_variances(gd_real out[3], const gd_attitude_candidate *m) {
  const gd_real error = m->kind.blocks == GD_ATTITUDE_QUIET_BLOCKS ? GD_R(0.0) : m->kind.bias * GD_ATTITUDE_REST_BIAS;
  int i;
  gd_attitude_scatter_variances(out, m);
  for (i = 0; i < 3; i++) {
    out[i] += error * error;
  }
}

/* The same where a hypothesis is tested. A rest that has to agree has the error of any rest. */
static inline void gd_attitude_test_variances(gd_real out[3], const gd_attitude_hypothesis *h,
                                              const gd_attitude_candidate *m) {
  int i;
  gd_attitude_mean_variances(out, m);
  for (i = 0; gd_attitude_must_agree(h, m) && i < 3; i++) {
    out[i] = m->gyro_var[i] * GD_ATTITUDE_SPREAD_WEIGHT / (gd_real)m->kind.blocks +
             GD_ATTITUDE_REST_BIAS * GD_ATTITUDE_REST_BIAS;
  }
}

/* The same as measurements of the bias. `overlap` is the factor of a window that contains blocks of an earlier
   update. */
static inline void gd_attitude_rest_variances(gd_real out[3], const gd_attitude_hypothesis *h,
                                              const gd_attitude_candidate *m, gd_real overlap) {
  const int is_noisy = m->kind.blocks > GD_ATTITUDE_QUIET_BLOCKS;
  const gd_real extra = h->knows_bias && is_noisy ? GD_ATTITUDE_NOISY_REST * GD_ATTITUDE_NOISY_REST : GD_R(0.0);
  int i;
  gd_attitude_mean_variances(out, m);
  for (i = 0; i < 3; i++) {
    out[i] = (out[i] + extra) * overlap;
  }
}

/* Matrix (3, 3) with these variances, and `extra` beside them, on its diagonal. */
static inline void gd_attitude_diagonal(gd_real out[9], const gd_real variance[3], gd_real extra) {
  int i;
  memset(out, 0, 9 * sizeof *out);
  for (i = 0; i < 3; i++) {
    out[4 * i] = variance[i] + extra;
  }
}

/* Update a hypothesis of rest by the candidate: its mean rates are the bias. The first update of a rest may find that
   the bias has jumped. */
static inline void gd_attitude_measure_rest(gd_attitude_hypothesis *h, gd_real error[GD_ATTITUDE_STATES],
                                            const gd_attitude_candidate *m, gd_real overlap, int is_first) {
  gd_real variance[3], matrix[9], off[3];
  gd_attitude_innovation innovation;
  int i;
  memset(error, 0, GD_ATTITUDE_STATES * sizeof *error);
  gd_attitude_rest_variances(variance, h, m, overlap);
  for (i = 0; i < 3; i++) {
    off[i] = m->gyro[i] - h->bias[i];
  }
  if (is_first) {
    gd_attitude_widen(h, off, variance);
  }
  gd_attitude_diagonal(matrix, variance, GD_R(0.0));
  gd_attitude_innovate(&innovation, h->cov, error, GD_ATTITUDE_BIAS, off, matrix);
  gd_attitude_measure(&innovation, h->cov, error);
}

/* Then its velocity is 0. */
static inline void gd_attitude_measure_standing(gd_attitude_hypothesis *h, gd_real error[GD_ATTITUDE_STATES],
                                                const gd_attitude_candidate *m) {
  const int is_quiet = m->kind.blocks <= GD_ATTITUDE_QUIET_BLOCKS;
  const gd_real speed = is_quiet ? GD_ATTITUDE_QUIET_SPEED : GD_ATTITUDE_NOISY_SPEED, none[3] = {0, 0, 0};
  gd_real matrix[9], back[3];
  gd_attitude_innovation innovation;
  int i;
  for (i = 0; i < 3; i++) {
    back[i] = -h->velocity[i];
  }
  gd_attitude_diagonal(matrix, none, speed * speed);
  gd_attitude_innovate(&innovation, h->cov, error, GD_ATTITUDE_VELOCITY, back, matrix);
  gd_attitude_measure(&innovation, h->cov, error);
  gd_attitude_correct(h, error);
  h->moving_s = 0;
  h->knows_bias = h->knows_bias || m->kind.blocks >= GD_ATTITUDE_QUIET_BLOCKS;
}

/* Update a hypothesis of an even turn: the rates about the level axes are biases. On these axes and the vertical the
   huge variance of the vertical rate takes no digits from theirs. */
static inline void gd_attitude_measure_turn(gd_attitude_hypothesis *h, const gd_attitude_candidate *m) {
  const gd_real error_rate = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_RAD;
  gd_real error[GD_ATTITUDE_STATES], variance[3], matrix[9], basis[9], off[3], up[3];
  gd_attitude_innovation innovation;
  int i;
  memset(error, 0, sizeof error);
  gd_attitude_rest_variances(variance, h, m, GD_R(1.0));
  gd_attitude_diagonal(matrix, variance, error_rate * error_rate + GD_ATTITUDE_ALIGNMENT * GD_ATTITUDE_ALIGNMENT *
                                                                       gd_dot(m->gyro, m->gyro));
  for (i = 0; i < 3; i++) {
    off[i] = m->gyro[i] - h->bias[i];
  }
  gd_attitude_vertical(up, h, m);
  gd_attitude_level_basis(basis, up);
  gd_attitude_innovate(&innovation, h->cov, error, GD_ATTITUDE_BIAS, off, matrix);
  gd_attitude_turn_basis(&innovation, basis, GD_ATTITUDE_FREE_RATE * GD_ATTITUDE_FREE_RATE);
  gd_attitude_measure(&innovation, h->cov, error);
  gd_attitude_correct(h, error);
}

/* Logarithms of the weights of rest and of no rest, for hypothesis `i`. */
static inline void gd_attitude_weigh_branches(gd_attitude *a, gd_attitude_job *job, int i) {
  const gd_attitude_candidate *m = &job->candidate;
  const gd_attitude_hypothesis *h = gd_attitude_at(a, i);
  gd_real variance[3], up[3];
  gd_attitude_test_variances(variance, h, m);
  gd_attitude_vertical(up, h, m);
  gd_attitude_weigh(&job->log_rest[i], &job->log_motion[i], a, h, m, up, variance);
  job->log_rest[i] += job->odds > 0 ? GD_LOG(job->odds) : GD_ATTITUDE_LOG_LEAST;
}

/* The largest of these logarithms. */
static inline gd_real gd_attitude_largest_log(const gd_attitude *a, const gd_attitude_job *job) {
  gd_real most = job->log_rest[0];
  int i;
  for (i = 0; i < a->sum.count; i++) {
    most = gd_max(most, gd_max(job->log_rest[i], job->log_motion[i]));
  }
  return most;
}

/* Hypotheses after a new candidate: of rest, and of no rest. The list has the rests first. */
static inline void gd_attitude_branch(gd_attitude *a, gd_attitude_job *job) {
  const gd_real *log_rest = job->log_rest, *log_motion = job->log_motion, most = gd_attitude_largest_log(a, job);
  gd_attitude_sum *sum = &a->sum;
  uint8_t motions[GD_ATTITUDE_SLOTS];
  int i, rests = 0, turns = 0;
  for (i = 0; i < sum->count; i++) {
    const gd_real log_ratio = log_rest[i] - log_motion[i], weight = gd_attitude_at(a, i)->weight;
    const uint8_t slot = sum->order[i];
    const int is_rest = log_ratio > -GD_ATTITUDE_CERTAIN;
    if (log_ratio < GD_ATTITUDE_CERTAIN || !is_rest) {
      const uint8_t copy = is_rest ? gd_attitude_free_slot(sum, motions, turns) : slot;
      sum->slot[copy] = sum->slot[slot];
      sum->slot[copy].weight = weight * GD_EXP(gd_max(log_motion[i] - most, -GD_ATTITUDE_LARGEST_LOG));
      sum->slot[copy].regime = GD_ATTITUDE_TURN;
      motions[turns++] = copy;
    }
    if (is_rest) {
      sum->slot[slot].weight = weight * GD_EXP(gd_max(log_rest[i] - most, -GD_ATTITUDE_LARGEST_LOG));
      sum->slot[slot].regime = GD_ATTITUDE_REST;
      sum->order[rests++] = slot;
    }
  }
  for (i = 0; i < turns; i++) {
    sum->order[rests + i] = motions[i];
  }
  sum->count = (uint8_t)(rests + turns);
  job->rests = (uint8_t)rests;
}

/* Measure hypothesis `i` of them by the candidate. */
static inline void gd_attitude_measure_branch(gd_attitude *a, gd_attitude_job *job, int i) {
  if (i < job->rests) {
    gd_attitude_add_drift(a, gd_attitude_at(a, i), &job->candidate);
    gd_attitude_measure_rest(gd_attitude_at(a, i), job->error, &job->candidate, GD_R(1.0), 1);
  } else {
    gd_attitude_measure_turn(gd_attitude_at(a, i), &job->candidate);
  }
}

#endif
