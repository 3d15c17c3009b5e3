/* Attitude filter: the bounded velocity: a motion that returns shows the tilt, because a wrong tilt makes the
   velocity grow. Vehicles do not return: theirs counts less, and hardly at all about the vertical while they stay
   level. */
#ifndef GD_ATTITUDE_VELOCITY_H
#define GD_ATTITUDE_VELOCITY_H

#include "attitude_measure.h"

/* Standard deviation of the velocity at the first sample, m/s. */
#define GD_ATTITUDE_START_SPEED GD_R(0.5)
/* Standard deviation of the bounded velocity, m/s, and its correlation time, s. */
#define GD_ATTITUDE_SPEED GD_R(1.0)
#define GD_ATTITUDE_CORRELATION_S GD_R(0.5)
/* Averaging times of the velocity and of its square, s. */
#define GD_ATTITUDE_SLOW_S GD_R(2.0)
#define GD_ATTITUDE_SPEED_MEMORY_S GD_R(10.0)
/* Variance of the velocity's measurement over that of the slow velocity, and its largest factor. */
#define GD_ATTITUDE_SPEED_FACTOR GD_R(6.0)
#define GD_ATTITUDE_MOST_FACTOR GD_R(40.0)
/* Averaging time of the vertical in the sensor, s, and its variance, rad^2, at which half of the gains about it
   count. */
#define GD_ATTITUDE_UP_MEMORY_S GD_R(20.0)
#define GD_ATTITUDE_UP_VAR (GD_R(15.0 * 0.017453292519943295) * GD_R(15.0 * 0.017453292519943295))
/* Weight of the velocity in the probabilities of hypotheses. */
#define GD_ATTITUDE_LIKELIHOOD_SHARE GD_R(0.1)
/* Squared distance of a velocity from 0 beyond which its measurement counts less: 3 sigma (Huber). */
#define GD_ATTITUDE_OUTLIER GD_R(9.0)

/* Velocity as at the first sample: without acceleration it is unknown, and shows no tilt. */
static inline void gd_attitude_forget_velocity(gd_attitude *a) {
  int i, k;
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    for (k = 0; k < 3; k++) {
      h->velocity[k] = 0;
      gd_reset_state(h->cov, GD_ATTITUDE_VELOCITY + k, GD_ATTITUDE_START_SPEED * GD_ATTITUDE_START_SPEED);
    }
  }
}

/* Factor on the variance of the bounded velocity, 1 for motions that return, by the velocity's slow part. */
static inline gd_real gd_attitude_speed_factor(gd_attitude *a, gd_real seconds) {
  gd_attitude_motion *m = &a->motion;
  const gd_attitude_hypothesis *h = gd_attitude_at(a, 0);
  const gd_real share = gd_min(GD_R(1.0), seconds / GD_ATTITUDE_SLOW_S);
  gd_real squared;
  int i;
  for (i = 0; i < 3; i++) {
    m->slow_velocity[i] += (h->velocity[i] - m->slow_velocity[i]) * share;
  }
  squared = gd_dot(m->slow_velocity, m->slow_velocity) / GD_R(3.0);
  m->speed_var += (squared - m->speed_var) * gd_min(GD_R(1.0), seconds / GD_ATTITUDE_SPEED_MEMORY_S);
  squared = GD_ATTITUDE_SPEED_FACTOR * m->speed_var / (GD_ATTITUDE_SPEED * GD_ATTITUDE_SPEED);
  return gd_min(gd_max(GD_R(1.0), squared), GD_ATTITUDE_MOST_FACTOR);
}

/* Share of the gains about the vertical: small for a vehicle (`factor` above 1) that stays level. */
static inline gd_real gd_attitude_share_of_vertical(gd_attitude *a, gd_real seconds, gd_real factor) {
  gd_attitude_motion *m = &a->motion;
  const gd_real share = gd_is_zero(m->mean_up) ? GD_R(1.0) : gd_min(GD_R(1.0), seconds / GD_ATTITUDE_UP_MEMORY_S);
  gd_real up[3], variance;
  int i;
  gd_up_in_sensor(up, gd_attitude_at(a, 0)->q);
  for (i = 0; i < 3; i++) {
    m->mean_up[i] += (up[i] - m->mean_up[i]) * share;
  }
  variance = gd_max(GD_R(1e-6), GD_R(1.0) - gd_dot(m->mean_up, m->mean_up));
  variance *= variance;
  return variance / (variance + GD_ATTITUDE_UP_VAR * GD_ATTITUDE_UP_VAR * gd_min(GD_R(1.0), factor - GD_R(1.0)));
}

/* Variance of a velocity that is measured as 0: larger where its distance from 0 is an outlier. */
static inline gd_real gd_attitude_outlier_variance(const gd_attitude_hypothesis *h, gd_real variance) {
  gd_real spread[9], inverse[9];
  int i;
  gd_diagonal_block(spread, h->cov, GD_ATTITUDE_VELOCITY);
  for (i = 0; i < 3; i++) {
    spread[4 * i] += variance;
  }
  gd_invert(inverse, 0, spread);
  return variance * gd_max(GD_R(1.0), gd_quadratic(inverse, h->velocity) / GD_ATTITUDE_OUTLIER);
}

/* Measure a velocity of 0 for a hypothesis; the logarithm of its likelihood. */
static inline gd_real gd_attitude_measure_velocity(gd_attitude_hypothesis *h, gd_real variance, gd_real share) {
  gd_real error[GD_ATTITUDE_STATES], back[3], noise[9], up[3];
  gd_attitude_innovation m;
  int i;
  memset(error, 0, sizeof error);
  memset(noise, 0, sizeof noise);
  variance = gd_attitude_outlier_variance(h, variance);
  for (i = 0; i < 3; i++) {
    back[i] = -h->velocity[i];
    noise[4 * i] = variance;
  }
  gd_attitude_innovate(&m, h->cov, error, GD_ATTITUDE_VELOCITY, back, noise);
  if (share < 1) {
    gd_up_in_sensor(up, h->q);
    gd_attitude_measure_in_part(&m, h->cov, error, up, share);
  } else {
    gd_attitude_measure(&m, h->cov, error);
  }
  gd_attitude_correct(h, error);
  return gd_attitude_log_likelihood(&m);
}

/* Find how far a velocity of 0 can be trusted that is off by the speed of bounded motions. */
static inline void gd_attitude_begin_velocity(gd_attitude *a, gd_attitude_job *job) {
  const gd_real seconds = job->block.seconds;
  job->factor = gd_attitude_speed_factor(a, seconds);
  job->share = gd_attitude_share_of_vertical(a, seconds, job->factor);
  job->velocity_var =
      job->factor * (GD_ATTITUDE_SPEED * GD_ATTITUDE_SPEED) * GD_R(2.0) * GD_ATTITUDE_CORRELATION_S / seconds;
}

/* Weigh the hypotheses by that velocity. Not during a rest candidate: rest and even turn predict the same
   accelerations, and no weight changes. */
static inline void gd_attitude_weigh_velocity(gd_attitude *a, const gd_attitude_job *job) {
  const gd_real *log_likelihood = job->log_rest;
  gd_real most = log_likelihood[0];
  int i;
  for (i = 1; i < a->sum.count; i++) {
    most = gd_max(most, log_likelihood[i]);
  }
  if (a->sum.count > 1 && a->segment.blocks <= 0) {
    for (i = 0; i < a->sum.count; i++) {
      gd_attitude_at(a, i)->weight *= GD_EXP(GD_ATTITUDE_LIKELIHOOD_SHARE / job->factor * (log_likelihood[i] - most));
    }
    gd_attitude_normalize(&a->sum);
  }
}

#endif
