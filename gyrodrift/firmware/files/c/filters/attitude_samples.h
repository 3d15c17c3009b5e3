/* Attitude filter: a sample that is summed up, and samples that wait for the work of the block before. */
#ifndef GD_ATTITUDE_SAMPLES_H
#define GD_ATTITUDE_SAMPLES_H

#include "attitude_portions.h"
#include "attitude_spikes.h"

/* Accelerations above this are no measurements, m/s^2. */
#define GD_ATTITUDE_LARGEST_MPS2 GD_R(4000.0)
/* Equal accelerations in a row above this are the end of a range, m/s^2: the smallest range is 2 g. */
#define GD_ATTITUDE_CLIPPED_MPS2 GD_R(18.0)
/* Time for which an acceleration holds, s: an accelerometer may be slower than the gyro. */
#define GD_ATTITUDE_HOLD_S 0.1
/* Samples that wait and are summed up in a portion: as long as an update of a hypothesis. */
#define GD_ATTITUDE_SAMPLES_PER_PORTION 3

/* Whether an acceleration equals the one before at the end of its range. */
static inline int gd_attitude_is_clipped(const gd_real accel[3], const gd_real before[3]) {
  int i;
  for (i = 0; i < 3; i++) {
    if (GD_ABS(accel[i]) > GD_ATTITUDE_CLIPPED_MPS2 && accel[i] >= before[i] && accel[i] <= before[i]) {
      return 1;
    }
  }
  return 0;
}

/* Take the acceleration of a sample: the last one holds for a short time, then NaN. Three zeros are none: noise is
   missing. */
static inline void gd_attitude_take_accel(gd_attitude *a, double t_s, const gd_real accel[3]) {
  const gd_real size = gd_dot(accel, accel);
  if (size > 0 && size < GD_ATTITUDE_LARGEST_MPS2 * GD_ATTITUDE_LARGEST_MPS2) {
    if (size > GD_ATTITUDE_CLIPPED_MPS2 * GD_ATTITUDE_CLIPPED_MPS2 && gd_attitude_is_clipped(accel, a->accel_mps2)) {
      a->block.is_clipped = 1;
    }
    memcpy(a->accel_mps2, accel, sizeof a->accel_mps2);
    a->accel_t_s = t_s;
  } else if (!(t_s - a->accel_t_s <= GD_ATTITUDE_HOLD_S)) {
    a->accel_mps2[0] = a->accel_mps2[1] = a->accel_mps2[2] = (gd_real)NAN;
  }
}

/* Turn the block and the output by the mean of this sample and the one before. */
static inline void gd_attitude_turn(gd_attitude *a, double dt_s, const gd_real gyro[3], const gd_real before[3]) {
  const int has_before = gd_are_finite(before);
  gd_real rate[3], accel[3], axis[3], dt;
  dt = (gd_real)dt_s;
  gd_attitude_mean_rate(rate, a, dt, gyro);
  gd_attitude_middle(accel, a->accel_mps2, has_before ? before : a->accel_mps2);
  gd_attitude_add_sample(&a->block, dt_s, rate, accel);
  gd_product(a->q, a->start_q, a->block.q);
  gd_heading_axis(axis, a->q);
  a->heading_rate_dps = gd_dot(axis, a->gyro_dps);
  a->tilt_deg = gd_tilt_deg(a->q);
  gd_attitude_set_heading(a, gd_unwrapped_deg(a->heading_deg + (a->heading_rate_dps - a->bias_dps) * dt, a->q));
}

/* Output that follows the samples. */
typedef struct {
  gd_real q[4], yaw_deg, heading_deg, tilt_deg, heading_rate_dps;
  int32_t turns;
} gd_attitude_output;

static inline gd_attitude_output gd_attitude_output_of(const gd_attitude *a) {
  gd_attitude_output output;
  memcpy(output.q, a->q, sizeof output.q);
  output.yaw_deg = a->yaw_deg;
  output.heading_deg = a->heading_deg;
  output.tilt_deg = a->tilt_deg;
  output.heading_rate_dps = a->heading_rate_dps;
  output.turns = a->turns;
  return output;
}

/* Set it again; whole turns may have been counted meanwhile. */
static inline void gd_attitude_show(gd_attitude *a, const gd_attitude_output *output) {
  memcpy(a->q, output->q, sizeof a->q);
  a->yaw_deg = output->yaw_deg;
  a->heading_deg = output->heading_deg + GD_R(360.0) * (gd_real)(output->turns - a->turns);
  a->tilt_deg = output->tilt_deg;
  a->heading_rate_dps = output->heading_rate_dps;
}

/* Begin to pass the gap before a sample. 0: the block before it must end first. */
static inline int gd_attitude_begin_gap(gd_attitude *a, const gd_attitude_sample *x) {
  gd_attitude_job *job = &a->job;
  if (!job->is_at_gap) {
    job->is_at_gap = 1;
    job->before_deg = a->heading_deg;
    job->turns_before = a->turns;
    if (a->block.samples > 0) {
      gd_attitude_begin_job(a);
      return 0;
    }
  }
  job->waits = job->is_divided;
  job->still = x->still;
  job->temp_c = x->temp_c;
  if (gd_attitude_pass_gap(a, x->dt_s, x->gyro)) {
    gd_attitude_begin_merge(a, GD_ATTITUDE_REOPEN);
  } else {
    gd_attitude_go_to(job, GD_ATTITUDE_REOPEN);
  }
  return 1;
}

/* Sum up a sample. 0: the block before a gap must end first. */
static inline int gd_attitude_start(gd_attitude *a, const gd_attitude_sample *x) {
  gd_real before[3];
  memcpy(before, a->accel_mps2, sizeof before);
  if (a->job.is_guess) {
    a->job.is_guess = 0;
    a->heading_deg = a->job.heading_deg;
    gd_product(a->q, a->start_q, a->block.q);
  }
  if (!a->job.is_at_gap) {
    gd_attitude_take_accel(a, x->t_s, x->accel);
  }
  if (a->samples == 0) {
    memcpy(a->gyro_dps, x->gyro, sizeof a->gyro_dps);
    gd_attitude_begin(a, a->accel_mps2);
  } else if (x->dt_s > a->longest_step_s) {
    return gd_attitude_begin_gap(a, x);
  } else {
    gd_attitude_turn(a, x->dt_s, x->gyro, before);
  }
  gd_attitude_note_sample(a, x->still, x->temp_c);
  if (a->block.seconds >= a->c.block_s - 1e-9 && a->block.samples >= 2) {
    a->longest_step_s = gd_longest_step_s(a->block.seconds / (double)a->block.samples);
    gd_attitude_begin_job(a);
  }
  return 1;
}

/* Sum up some samples that wait, up to the end of the next block. */
static inline void gd_attitude_take_waiting(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  int i;
  for (i = 0; i < GD_ATTITUDE_SAMPLES_PER_PORTION && job->stage == GD_ATTITUDE_IDLE && job->queued > 0; i++) {
    if (gd_attitude_start(a, &job->queue[job->oldest])) {
      job->oldest = (uint8_t)((job->oldest + 1) % GD_ATTITUDE_QUEUE);
      job->queued--;
    }
  }
}

/* Do what is left of the work. */
static inline void gd_attitude_catch_up(gd_attitude *a) {
  while (a->job.stage != GD_ATTITUDE_IDLE || a->job.queued > 0) {
    if (a->job.stage != GD_ATTITUDE_IDLE) {
      gd_attitude_do_portion(a);
    } else {
      gd_attitude_take_waiting(a);
    }
  }
}

/* Turn the output by the last one of the samples that wait, by the last estimates. */
static inline void gd_attitude_guess(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  const int i = job->queued - 1;
  const gd_attitude_sample *x = &job->queue[(job->oldest + i) % GD_ATTITUDE_QUEUE];
  const gd_real *before = i > 0 ? job->queue[(job->oldest + i - 1) % GD_ATTITUDE_QUEUE].gyro : a->gyro_dps;
  const gd_real dt = x->dt_s > a->longest_step_s ? GD_R(0.0) : (gd_real)x->dt_s;
  gd_real rate[3], turn[4], axis[3];
  int k;
  if (!job->is_guess) {
    job->is_guess = 1;
    job->heading_deg = a->heading_deg;
  }
  gd_attitude_middle(rate, x->gyro, before);
  for (k = 0; k < 3; k++) {
    rate[k] = (rate[k] - a->bias_xyz_dps[k]) * GD_ATTITUDE_RAD * dt;
  }
  gd_from_small_vector(turn, rate[0], rate[1], rate[2]);
  gd_product(a->q, a->q, turn);
  gd_heading_axis(axis, a->q);
  a->heading_rate_dps = gd_dot(axis, x->gyro);
  a->tilt_deg = gd_tilt_deg(a->q);
  gd_attitude_set_heading(a, gd_unwrapped_deg(a->heading_deg + gd_dot(axis, rate) / GD_ATTITUDE_RAD, a->q));
}

/* Take an accepted sample. It waits if the last block is still worked on. */
static inline void gd_attitude_take(gd_attitude *a, double t_s, double dt_s, const gd_real gyro[3],
                                    const gd_real accel[3], gd_real still, gd_real temp_c) {
  gd_attitude_job *job = &a->job;
  gd_attitude_sample *x;
  a->correction_deg = 0;
  a->t_s = t_s;
  if (job->queued == GD_ATTITUDE_QUEUE) {
    gd_attitude_catch_up(a);
  }
  x = &job->queue[(job->oldest + job->queued) % GD_ATTITUDE_QUEUE];
  job->queued++;
  x->t_s = t_s;
  x->dt_s = dt_s;
  memcpy(x->gyro, gyro, sizeof x->gyro);
  memcpy(x->accel, accel, sizeof x->accel);
  x->still = still;
  x->temp_c = temp_c;
  if (job->queued == 1) {
    gd_attitude_take_waiting(a);
  }
  if (job->stage != GD_ATTITUDE_IDLE && !job->waits) {
    gd_attitude_catch_up(a);
  }
  if (job->queued > 0) {
    gd_attitude_guess(a);
  }
}

/* Does a portion of the work of a block, or sums up some samples that wait. Meanwhile the output stays ahead. */
static inline void gd_attitude_do_next(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  const gd_attitude_output output = gd_attitude_output_of(a);
  const int was_guess = job->is_guess;
  if (job->stage != GD_ATTITUDE_IDLE) {
    gd_attitude_do_portion(a);
  } else {
    gd_attitude_take_waiting(a);
  }
  if (was_guess && !job->is_guess && job->queued > 0) {
    job->is_guess = 1;
    job->heading_deg = a->heading_deg;
    gd_attitude_show(a, &output);
  }
}

/* Takes the next step as a gap, whatever its length is: samples are missing. */
static inline void gd_attitude_gap(gd_attitude *a) {
  gd_attitude_catch_up(a);
  if (a->samples > 0 && a->longest_step_s > GD_TOLD_GAP) {
    a->longest_step_s = GD_TOLD_GAP;
  }
}

/* Takes the next step as a restart of the gyro: its biases are others, and the next sample may have any time. */
static inline void gd_attitude_restarted(gd_attitude *a) {
  gd_attitude_catch_up(a);
  if (a->samples > 0) {
    a->longest_step_s = GD_TOLD_RESTART;
  }
}

#endif
