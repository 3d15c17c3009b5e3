/* Attitude filter: densities of the mean rates of a rest candidate under a rest, and under an even turn or motion.

   Python adds densities; here their logarithms are added, as float has no 1e-300. */
#ifndef GD_ATTITUDE_EVIDENCE_H
#define GD_ATTITUDE_EVIDENCE_H

#include "attitude_rests.h"

/* Motions that keep their means by chance: spread of their rates in each axis, deg/s, and their number per even turn,
   in quiet and in noisy windows. */
#define GD_ATTITUDE_MOTION_SPREAD GD_R(1.0)
#define GD_ATTITUDE_MOTION_SHARE GD_R(0.05)
#define GD_ATTITUDE_NOISY_MOTION_SHARE GD_R(0.5)
/* Share of rests before which the bias jumped, as the raw parts, and the size of jumps over the spread of the bias. */
#define GD_ATTITUDE_JUMP_SHARE GD_R(0.03)
#define GD_ATTITUDE_JUMP GD_R(0.4)
/* Share of parts whose three axes are of one kind. */
#define GD_ATTITUDE_ONE_KIND GD_R(0.8)
/* Share of a rate that the level axes see: errors of the tilt by 0.3 m/s^2 of bias of the accelerometer. */
#define GD_ATTITUDE_ALIGNMENT GD_R(0.03)
/* Share of rests before which the bias was learned in an even turn, so that it has its prior again. */
#define GD_ATTITUDE_MISTAKE_SHARE GD_R(0.005)
/* Error of the bias that its covariance does not contain, deg/s, where a rest is tested. */
#define GD_ATTITUDE_MODEL_ERROR GD_R(0.1)
/* Change of a bias within a rest that its covariance does not contain, deg/s. */
#define GD_ATTITUDE_SAME_RATE GD_R(0.005)
/* Logarithms of 1e-300, the smallest density, and of 2 pi. */
#define GD_ATTITUDE_LOG_LEAST GD_R(-690.7755278982137)
#define GD_ATTITUDE_LOG_TURN GD_R(1.8378770664093453)

/* Logarithm of the sum of two numbers whose logarithms are given. */
static inline gd_real gd_log_add(gd_real a, gd_real b) {
  const gd_real most = gd_max(a, b);
  return most + GD_LOG(GD_R(1.0) + GD_EXP(gd_min(a, b) - most));
}

/* Logarithm of a normal density with the covariance s + extra I of `size` (1 to 3) components, off its mean. */
static inline gd_real gd_log_density(const gd_real *off, const gd_real s[9], gd_real extra, int size) {
  gd_real l[3], d[3], wide[9], y[3], squared = 0, log_det = 0;
  int i;
  memcpy(wide, s, sizeof wide);
  for (i = 0; i < 3; i++) {
    wide[4 * i] += extra;
  }
  gd_factorize(l, d, wide);
  y[0] = off[0];
  y[1] = size > 1 ? off[1] - l[0] * y[0] : GD_R(0.0);
  y[2] = size > 2 ? off[2] - l[1] * y[0] - l[2] * y[1] : GD_R(0.0);
  for (i = 0; i < size; i++) {
    squared += y[i] * y[i] / d[i];
    log_det += GD_LOG(d[i]) + GD_ATTITUDE_LOG_TURN;
  }
  return GD_R(-0.5) * (squared + log_det);
}

/* Matrix (3, 3) whose rows are two level axes and the vertical, in the sensor frame. */
static inline void gd_attitude_level_basis(gd_real basis[9], const gd_real up[3]) {
  gd_real first[3] = {0, 0, 0}, along, size;
  int i, least = 0;
  for (i = 1; i < 3; i++) {
    least = GD_ABS(up[i]) < GD_ABS(up[least]) ? i : least;
  }
  first[least] = 1;
  along = up[least];
  for (i = 0; i < 3; i++) {
    first[i] -= along * up[i];
  }
  size = GD_SQRT(gd_dot(first, first));
  for (i = 0; i < 3; i++) {
    basis[i] = first[i] / size;
    basis[6 + i] = up[i];
  }
  gd_cross(&basis[3], up, basis);
}

/* Logarithms of the densities before any rest has shown the bias: of the level rates, and of all rates of a rest. The
   level rates, as distances from the mean of the prior, are biases in every case, and show the kind of the part. */
static inline void gd_attitude_log_first_rest(gd_real *level, gd_real *rest, gd_real prior_var, const gd_real rate[3],
                                              gd_real off, gd_real variance) {
  const gd_real zero[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, error_var = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_MODEL_ERROR;
  gd_real vertical = GD_ATTITUDE_LOG_LEAST;
  uint8_t k;
  *level = *rest = GD_ATTITUDE_LOG_LEAST;
  for (k = 0; k < GD_PARTS; k++) {
    const gd_real factor = gd_part_wider(k) * gd_part_wider(k), log_share = GD_LOG(gd_part_share(k));
    const gd_real density = log_share + gd_log_density(rate, zero, factor * prior_var + error_var, 2);
    const gd_real along = gd_log_density(&off, zero, variance * factor + error_var, 1);
    *level = gd_log_add(*level, density);
    *rest = gd_log_add(*rest, density + along);
    vertical = gd_log_add(vertical, log_share + along);
  }
  vertical += GD_LOG(GD_R(1.0) - GD_ATTITUDE_ONE_KIND) + *level;
  *rest = gd_log_add(GD_LOG(GD_ATTITUDE_ONE_KIND) + *rest, vertical);
}

/* Whether a candidate is a noisy rest, and the bias of a hypothesis is sure. Such a rest has to agree with the bias: a
   straight drive or a gentle bend looks the same. */
static inline int gd_attitude_must_agree(const gd_attitude_hypothesis *h, const gd_attitude_candidate *m) {
  const gd_real most = GD_ATTITUDE_MODEL_ERROR * GD_ATTITUDE_RAD;
  gd_real spread[9];
  gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
  return m->kind.blocks > GD_ATTITUDE_QUIET_BLOCKS && h->knows_bias &&
         spread[0] + spread[4] + spread[8] < GD_R(3.0) * most * most;
}

/* Sigma of the drift of a bias since the last rest, rad/s. */
static inline gd_real gd_attitude_drift(const gd_attitude *a, const gd_attitude_hypothesis *h,
                                        const gd_attitude_candidate *m) {
  const gd_real seconds = gd_min(h->moving_s, GD_MAX_RAMP_S);
  return h->knows_bias && !gd_attitude_must_agree(h, m) ? a->c.drift_rate * seconds : GD_R(0.0);
}

/* Add the drift since the last rest to a covariance. It grew evenly, so the error of the heading is half of its end
   value times the time since the rest. */
static inline void gd_attitude_add_drift(const gd_attitude *a, gd_attitude_hypothesis *h,
                                         const gd_attitude_candidate *m) {
  const gd_real drift = gd_attitude_drift(a, h, m), half_s = GD_R(0.5) * h->moving_s;
  gd_real up[3];
  int i;
  gd_up_in_sensor(up, h->q);
  gd_add_variance(h->cov, GD_ATTITUDE_BIAS, drift * drift);
  h->cov[gd_place(GD_ATTITUDE_HEADING, GD_ATTITUDE_HEADING)] += drift * drift * half_s * half_s;
  for (i = 0; i < 3; i++) {
    h->cov[gd_place(GD_ATTITUDE_HEADING, GD_ATTITUDE_BIAS + i)] -= drift * drift * half_s * up[i];
  }
}

/* A candidate's rates for a hypothesis: mean rates and distance from the bias, deg/s, with the covariance of the
   distance, (deg/s)^2, on two level axes and the vertical. `error_var` is the variance by errors of the model. */
typedef struct {
  gd_real rate[3], turn_on[3], off[3], spread[9], error_var; /* turn_on: from the mean of the prior of the bias */
} gd_attitude_offset;

static inline void gd_attitude_offset_of(gd_attitude_offset *out, const gd_attitude *a,
                                         const gd_attitude_hypothesis *h, const gd_attitude_candidate *m,
                                         const gd_real up[3], const gd_real variance[3]) {
  const gd_real drift = gd_attitude_drift(a, h, m);
  const gd_real error = h->knows_bias ? GD_ATTITUDE_SAME_RATE : GD_ATTITUDE_MODEL_ERROR;
  gd_real basis[9], off[3], rate[3], turn_on[3], spread[9];
  int i;
  gd_attitude_level_basis(basis, up);
  gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
  for (i = 0; i < 3; i++) {
    rate[i] = m->gyro[i] / GD_ATTITUDE_RAD;
    off[i] = (m->gyro[i] - h->bias[i]) / GD_ATTITUDE_RAD;
    spread[4 * i] += variance[i] + drift * drift;
  }
  for (i = 0; i < 9; i++) {
    spread[i] /= GD_ATTITUDE_RAD * GD_ATTITUDE_RAD;
  }
  gd_times(out->rate, basis, rate);
  gd_times(turn_on, basis, a->turn_on_bias);
  for (i = 0; i < 3; i++) {
    out->turn_on[i] = out->rate[i] - turn_on[i] / GD_ATTITUDE_RAD;
  }
  gd_times(out->off, basis, off);
  gd_in_basis(out->spread, basis, spread);
  out->error_var = error * error +
                   GD_ATTITUDE_ALIGNMENT * GD_ATTITUDE_ALIGNMENT * gd_dot(out->rate, out->rate);
}

/* Logarithm of the density of a rest whose bias is known, and may have jumped. */
static inline gd_real gd_attitude_log_known_rest(const gd_attitude_hypothesis *h, const gd_attitude_offset *o,
                                                 gd_real prior_var, int may_jump) {
  const gd_real jump_var = GD_ATTITUDE_JUMP * GD_ATTITUDE_JUMP * prior_var;
  const gd_real jumps = GD_ATTITUDE_JUMP_SHARE * gd_min(GD_R(1.0), h->moving_s / GD_MAX_RAMP_S);
  gd_real rest = gd_log_density(o->off, o->spread, o->error_var, 3);
  if (may_jump) {
    const gd_real jumped = gd_log_density(o->off, o->spread, o->error_var + jump_var, 3);
    rest = gd_log_add(GD_LOG(GD_R(1.0) - jumps) + rest, GD_LOG(jumps) + jumped);
  }
  if (gd_dot(o->rate, o->rate) < gd_dot(h->bias, h->bias) / (GD_ATTITUDE_RAD * GD_ATTITUDE_RAD)) {
    rest = gd_log_add(rest, GD_LOG(GD_ATTITUDE_MISTAKE_SHARE) + gd_log_density(o->rate, o->spread, prior_var, 3));
  }
  return rest;
}

/* Logarithms of the densities, 1/(deg/s)^3, of a candidate's rates for a hypothesis: rest, and no rest for each unit of
   odds. `up` is the vertical (3) in the sensor, `variance` (3) that of the mean rates as a measurement, (rad/s)^2. */
static inline void gd_attitude_weigh(gd_real *log_rest, gd_real *log_motion, const gd_attitude *a,
                                     const gd_attitude_hypothesis *h, const gd_attitude_candidate *m,
                                     const gd_real up[3], const gd_real variance[3]) {
  const gd_attitude_coefficients *c = &a->c;
  const gd_real sigma = c->bias_sigma / GD_ATTITUDE_RAD;
  const gd_real share =
      m->kind.blocks <= GD_ATTITUDE_QUIET_BLOCKS ? GD_ATTITUDE_MOTION_SHARE : GD_ATTITUDE_NOISY_MOTION_SHARE;
  const gd_real none[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  gd_attitude_offset o;
  gd_real level, rest, chance, vertical_var;
  gd_attitude_offset_of(&o, a, h, m, up, variance);
  level = gd_log_density(o.off, o.spread, o.error_var, 2);
  chance = gd_log_density(o.off, o.spread, o.error_var + GD_ATTITUDE_MOTION_SPREAD * GD_ATTITUDE_MOTION_SPREAD, 3);
  if (h->knows_bias) {
    rest = gd_attitude_log_known_rest(h, &o, sigma * sigma, !gd_attitude_must_agree(h, m));
  } else {
    gd_attitude_log_first_rest(&level, &rest, sigma * sigma, o.turn_on, o.off[2], o.spread[8]);
  }
  vertical_var = o.spread[8] + o.error_var + GD_ATTITUDE_MOTION_SPREAD * GD_ATTITUDE_MOTION_SPREAD;
  chance = gd_log_add(chance, level + gd_log_density(&o.off[2], none, vertical_var, 1)) + GD_LOG(share);
  *log_rest = gd_log_add(rest, GD_ATTITUDE_LOG_LEAST);
  *log_motion = gd_log_add(gd_log_add(GD_LOG(GD_SPINS_PER_DPS) + level, chance), GD_ATTITUDE_LOG_LEAST);
}

#endif
