/* Attitude filter: prediction of a hypothesis over a block.

   The rotation of the block belongs to a reference bias and scale. A hypothesis with another bias or scale corrects it
   by the derivatives, to first order. */
#ifndef GD_ATTITUDE_PREDICT_H
#define GD_ATTITUDE_PREDICT_H

#include "attitude_hypotheses.h"

/* Error of a rotation by what scale and misalignment do not explain, rad per root of the integral of squared rate. */
#define GD_ATTITUDE_TURN_NOISE GD_R(0.001)
/* Noise of the two axes that gravity corrects, rad/sqrt(s). */
#define GD_ATTITUDE_TILT_NOISE GD_R(0.0026179938779914944)
/* Noise of the velocity, m/s/sqrt(s). */
#define GD_ATTITUDE_ACCEL_NOISE GD_R(0.3)

/* State of column `column` of the derivatives. */
static inline int gd_attitude_column(int column) {
  return column < 3 ? GD_ATTITUDE_BIAS + column : GD_ATTITUDE_SCALE + column - 3;
}

/* Change of the rotation of the block (3) by another bias and scale than those of the reference. */
static inline void gd_attitude_change(gd_real out[3], const gd_attitude_hypothesis *h,
                                      const gd_attitude_hypothesis *reference, const gd_attitude_integrals *block) {
  gd_real bias[3], scaled[3];
  int i, k;
  for (i = 0; i < 3; i++) {
    bias[i] = h->bias[i] - reference->bias[i];
  }
  gd_times(scaled, reference->scale, bias);
  for (i = 0; i < 3; i++) {
    scaled[i] += bias[i];
  }
  for (i = 0; i < 3; i++) {
    out[i] = 0;
    for (k = 0; k < 9; k++) {
      out[i] += (h->scale[k] - reference->scale[k]) * block->by_scale[9 * i + k];
    }
    out[i] -= gd_dot(&block->by_bias[3 * i], scaled);
  }
}

/* Integral (3) of the specific force of a hypothesis, in the frame of the sensor at the beginning. */
static inline void gd_attitude_force(gd_real out[3], const gd_attitude_hypothesis *h, const gd_real change[3],
                                     const gd_attitude_integrals *block) {
  gd_real turned[3], biased[3];
  int i;
  gd_cross(turned, change, block->velocity);
  gd_times(biased, block->by_bias, h->force_bias);
  for (i = 0; i < 3; i++) {
    out[i] = block->velocity[i] + GD_R(0.5) * turned[i] - biased[i];
  }
}

static inline void gd_attitude_transition_of(gd_attitude_transition *t, const gd_real start[9], gd_real fall,
                                             const gd_attitude_integrals *block, int is_held) {
  int i, j, k;
  t->fall = fall;
  t->is_held = is_held;
  for (i = 0; i < 3; i++) {
    for (j = 0; j < 12; j++) {
      t->turn[i][j] = 0;
    }
    for (k = 0; k < 3; k++) {
      for (j = 0; j < 3; j++) {
        t->turn[i][j] -= start[3 * i + k] * block->by_bias[3 * k + j];
      }
      for (j = 0; j < 9; j++) {
        t->turn[i][3 + j] += start[3 * i + k] * block->by_scale[9 * k + j];
      }
    }
  }
}

/* Add column `column` of the derivatives (3, 12) times the row of a covariance to three rows. */
static inline void gd_attitude_add_rows(gd_real out[3][GD_ATTITUDE_ROW], const gd_attitude_transition *t, int column,
                                        const gd_real row[GD_ATTITUDE_ROW]) {
  const gd_real x = t->turn[0][column], y = t->turn[1][column], z = t->turn[2][column];
  int j;
  for (j = 0; j < GD_ATTITUDE_ROW; j++) {
    out[0][j] += x * row[j];
    out[1][j] += y * row[j];
    out[2][j] += z * row[j];
  }
}

/* The six changed rows (attitude, velocity) of F cov for the transition matrix F. Row by row, compilers take vector
   units. */
static inline void gd_attitude_carry_rows(gd_real out[6][GD_ATTITUDE_ROW], const gd_real *cov,
                                          const gd_attitude_transition *t) {
  const int turning = t->is_held ? GD_ATTITUDE_HEADING : 3;
  gd_real turn[3][GD_ATTITUDE_ROW], force[3][GD_ATTITUDE_ROW], row[GD_ATTITUDE_ROW];
  int i, j;
  memset(turn, 0, sizeof turn);
  memset(force, 0, sizeof force);
  for (j = 0; j < 12; j++) {
    gd_row(row, cov, gd_attitude_column(j));
    gd_attitude_add_rows(turn, t, j, row);
  }
  for (j = 0; j < 3; j++) {
    gd_row(row, cov, GD_ATTITUDE_FORCE_BIAS + j);
    gd_attitude_add_rows(force, t, j, row);
  }
  for (i = 0; i < 3; i++) {
    gd_row(out[i], cov, i);
    gd_row(out[3 + i], cov, GD_ATTITUDE_VELOCITY + i);
    for (j = 0; j < GD_ATTITUDE_ROW; j++) {
      out[3 + i][j] += force[i][j];
    }
  }
  for (j = 0; j < GD_ATTITUDE_ROW; j++) {
    out[3][j] += t->fall * (out[1][j] + GD_R(0.5) * turn[1][j]);
    out[4][j] -= t->fall * (out[0][j] + GD_R(0.5) * turn[0][j]);
  }
  for (i = 0; i < turning; i++) {
    for (j = 0; j < GD_ATTITUDE_ROW; j++) {
      out[i][j] += turn[i][j];
    }
  }
}

/* The first `count` of the same products with a vector (21). */
static inline void gd_attitude_carry(gd_real out[6], int count, const gd_attitude_transition *t, const gd_real *v) {
  gd_real turn[3];
  int i, j;
  for (i = 0; i < 3 && i < count; i++) {
    turn[i] = 0;
    for (j = 0; j < 3; j++) {
      turn[i] += t->turn[i][j] * v[GD_ATTITUDE_BIAS + j];
    }
    for (j = 0; j < 9; j++) {
      turn[i] += t->turn[i][3 + j] * v[GD_ATTITUDE_SCALE + j];
    }
    out[i] = i == GD_ATTITUDE_HEADING && t->is_held ? v[i] : v[i] + turn[i];
  }
  for (i = 3; i < count; i++) {
    out[i] = v[GD_ATTITUDE_VELOCITY + i - 3] + gd_dot(t->turn[i - 3], &v[GD_ATTITUDE_FORCE_BIAS]);
  }
  if (count > 3) {
    out[3] += t->fall * (v[1] + GD_R(0.5) * turn[1]);
  }
  if (count > 4) {
    out[4] -= t->fall * (v[0] + GD_R(0.5) * turn[0]);
  }
}

/* cov = F cov F' for the transition matrix F: only attitude and velocity change, so the rest of cov stays. */
static inline void gd_attitude_carry_covariance(gd_real *cov, const gd_attitude_transition *t) {
  static const uint8_t changed[6] = {0, 1, 2, 6, 7, 8};
  gd_real rows[6][GD_ATTITUDE_ROW], carried[6];
  int i, j;
  gd_attitude_carry_rows(rows, cov, t);
  for (i = 0; i < 6; i++) {
    gd_set_row(cov, changed[i], rows[i]);
  }
  for (i = 0; i < 6; i++) {
    gd_attitude_carry(carried, i + 1, t, rows[i]);
    for (j = 0; j <= i; j++) {
      cov[gd_place(changed[i], changed[j])] = carried[j];
    }
  }
}

/* Add the variances of a block. */
static inline void gd_attitude_add_noise(gd_real *cov, const gd_attitude_integrals *block, gd_real walk_var,
                                         gd_real noise_var, int is_held) {
  const gd_real turn_var = GD_ATTITUDE_TURN_NOISE * GD_ATTITUDE_TURN_NOISE * block->squared_turn;
  const gd_real turn = noise_var * block->seconds + turn_var;
  const gd_real tilt = GD_ATTITUDE_TILT_NOISE * GD_ATTITUDE_TILT_NOISE * block->seconds;
  cov[gd_place(0, 0)] += turn + tilt;
  cov[gd_place(1, 1)] += turn + tilt;
  cov[gd_place(GD_ATTITUDE_HEADING, GD_ATTITUDE_HEADING)] += is_held ? GD_R(0.0) : turn;
  gd_add_variance(cov, GD_ATTITUDE_BIAS, walk_var * block->seconds);
  gd_add_variance(cov, GD_ATTITUDE_VELOCITY, GD_ATTITUDE_ACCEL_NOISE * GD_ATTITUDE_ACCEL_NOISE * block->seconds);
}

/* Attitude q without its rotation about the vertical since `before`. */
static inline void gd_attitude_hold_heading(gd_real q[4], const gd_real before[4]) {
  gd_real turn[3];
  gd_vector_between(turn, before, q);
  turn[0] = turn[1] = 0;
  turn[GD_ATTITUDE_HEADING] = -turn[GD_ATTITUDE_HEADING];
  gd_turn_by(q, turn);
}

/* Carry the mean of a hypothesis over a block whose rotation has the bias and scale of the reference, and find the
   transition of its covariance. `is_held`: it stands still, and its heading stays. */
static inline void gd_attitude_predict(gd_attitude_transition *transition, gd_attitude_hypothesis *h,
                                       const gd_attitude_hypothesis *reference, const gd_attitude_integrals *block,
                                       int is_held) {
  gd_real start[9], before[4], change[3], force[3], velocity[3], turn[4];
  int i;
  gd_rotation_matrix(start, h->q);
  memcpy(before, h->q, sizeof before);
  gd_attitude_change(change, h, reference, block);
  gd_attitude_force(force, h, change, block);
  gd_times(velocity, start, force);
  gd_from_vector(turn, change);
  gd_product(turn, turn, block->rotation);
  gd_product(h->q, h->q, turn);
  gd_make_unit(h->q);
  if (is_held) {
    gd_attitude_hold_heading(h->q, before);
  }
  for (i = 0; i < 3; i++) {
    h->velocity[i] += velocity[i];
  }
  h->moving_s += block->seconds;
  h->velocity[2] -= GD_ATTITUDE_GRAVITY * block->seconds;
  gd_attitude_transition_of(transition, start, velocity[2], block, is_held);
}

/* Carry its covariance. */
static inline void gd_attitude_predict_covariance(gd_real *cov, const gd_attitude_transition *transition,
                                                  const gd_attitude_integrals *block, gd_real walk_var,
                                                  gd_real noise_var) {
  gd_attitude_carry_covariance(cov, transition);
  gd_repair(cov);
  gd_attitude_add_noise(cov, block, walk_var, noise_var, transition->is_held);
}

#endif
