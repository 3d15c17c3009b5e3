/* Attitude filter: samples between two updates, integrated once for all hypotheses.

   Forster et al., On-Manifold Preintegration for Real-Time Visual-Inertial Odometry, IEEE Trans. Robotics 33(1), 2017.
*/
#ifndef GD_ATTITUDE_BLOCK_H
#define GD_ATTITUDE_BLOCK_H

#include "attitude_quaternion.h"

/* Length of the steps of the derivatives and of the velocity, s. */
#define GD_ATTITUDE_SUB_STEP_S 0.008

/* Empty block, corrected by this bias (3), rad/s, and scale and misalignment (3, 3). */
static inline void gd_attitude_next_block(gd_attitude_block *b, const gd_real bias[3], const gd_real scale[9]) {
  gd_real matrix[9];
  int i;
  memset(b, 0, sizeof *b);
  for (i = 0; i < 9; i++) {
    matrix[i] = (i % 4 == 0 ? GD_R(1.0) : GD_R(0.0)) + scale[i];
    b->gain[i] = matrix[i] * GD_ATTITUDE_RAD;
  }
  gd_times(b->offset, matrix, bias);
  gd_identity(b->q);
  gd_identity(b->step_q);
}

/* Add the sums since the last step to those of the block, about the mean rotation of the step. */
static inline void gd_attitude_end_step(gd_attitude_block *b) {
  const gd_real seconds = (gd_real)b->step_s;
  gd_real start[9], middle[9], turn[3];
  int i, j, k;
  gd_rotation_matrix(start, b->step_q);
  gd_rotation_matrix(middle, b->q);
  for (i = 0; i < 9; i++) {
    middle[i] = GD_R(0.5) * middle[i] + GD_R(0.5) * start[i];
  }
  gd_times(turn, b->gain, b->angle);
  for (i = 0; i < 3; i++) {
    turn[i] -= seconds * b->offset[i];
    b->all_angle[i] += b->angle[i];
    b->all_velocity[i] += b->velocity[i];
  }
  for (i = 0; i < 3; i++) {
    b->force[i] += gd_dot(&middle[3 * i], b->velocity);
    for (j = 0; j < 3; j++) {
      b->by_bias[3 * i + j] += middle[3 * i + j] * seconds;
      for (k = 0; k < 3; k++) {
        b->by_scale[9 * i + 3 * j + k] += middle[3 * i + j] * turn[k];
      }
    }
  }
  b->squared_turn += gd_dot(turn, turn) / seconds;
  b->step_s = 0;
  for (i = 0; i < 3; i++) {
    b->angle[i] = b->velocity[i] = 0;
  }
  memcpy(b->step_q, b->q, sizeof b->q);
}

/* Turn a block by mean rates (deg/s) over dt, with the mean acceleration (m/s^2, or NaN). */
static inline void gd_attitude_add_sample(gd_attitude_block *b, double dt_s, const gd_real gyro[3],
                                          const gd_real accel[3]) {
  const gd_real dt = (gd_real)dt_s;
  gd_real moved[3], turned[3], turn[4];
  int i;
  for (i = 0; i < 3; i++) {
    moved[i] = gyro[i] * dt;
    b->angle[i] += moved[i];
    b->velocity[i] += accel[i] * dt;
  }
  gd_times(turned, b->gain, moved);
  gd_from_small_vector(turn, turned[0] - b->offset[0] * dt, turned[1] - b->offset[1] * dt,
                       turned[2] - b->offset[2] * dt);
  gd_product(b->q, b->q, turn);
  b->seconds += dt_s;
  gd_count(&b->samples);
  b->step_s += dt_s;
  if (b->step_s >= GD_ATTITUDE_SUB_STEP_S) {
    gd_attitude_end_step(b);
  }
}

/* Rotation, velocity and derivatives of a block with a sample or more. */
static inline void gd_attitude_integrals_of(gd_attitude_integrals *out, gd_attitude_block *b) {
  int i;
  if (b->step_s > 0) {
    gd_attitude_end_step(b);
  }
  out->seconds = (gd_real)b->seconds;
  memcpy(out->rotation, b->q, sizeof b->q);
  gd_make_unit(out->rotation);
  for (i = 0; i < 3; i++) {
    out->velocity[i] = b->force[i];
    out->gyro[i] = b->all_angle[i] * GD_ATTITUDE_RAD / out->seconds;
    out->accel[i] = b->all_velocity[i] / out->seconds;
  }
  out->by_bias = b->by_bias;
  out->by_scale = b->by_scale;
  out->squared_turn = b->squared_turn;
}

#endif
