/* Attitude filter: the order of the portions; see attitude_job.h. */
#ifndef GD_ATTITUDE_PORTIONS_H
#define GD_ATTITUDE_PORTIONS_H

#include "attitude_job.h"

/* The stage for hypothesis `i`. */
static inline void gd_attitude_do_hypothesis(gd_attitude *a, int i) {
  gd_attitude_job *job = &a->job;
  gd_attitude_hypothesis *h = gd_attitude_at(a, i);
  switch (job->stage) {
    case GD_ATTITUDE_PREDICT:
      gd_attitude_predict_one(a, job, i);
      job->stage = GD_ATTITUDE_CARRY;
      break;
    case GD_ATTITUDE_BOUND:
      job->log_rest[i] = gd_attitude_measure_velocity(h, job->velocity_var, job->share);
      break;
    case GD_ATTITUDE_WEIGH:
      gd_attitude_weigh_branches(a, job, i);
      break;
    case GD_ATTITUDE_AID:
      gd_attitude_take_aid(a, i, job->heading_deg);
      break;
    case GD_ATTITUDE_BRANCH:
      gd_attitude_measure_branch(a, job, i);
      job->stage = i < job->rests ? GD_ATTITUDE_STAND_BRANCH : GD_ATTITUDE_BRANCH;
      break;
    default:
      gd_attitude_measure_rest(h, job->error, &job->candidate, job->overlap, 0);
      job->stage = GD_ATTITUDE_STAND;
      break;
  }
}

/* Does a portion of a stage that has one for each hypothesis. */
static inline void gd_attitude_do_next_hypothesis(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  while (job->stage == GD_ATTITUDE_REPEAT && job->index < a->sum.count &&
         gd_attitude_at(a, job->index)->regime != GD_ATTITUDE_REST) {
    job->index++;
  }
  if (job->index < a->sum.count) {
    gd_attitude_do_hypothesis(a, job->index++);
  } else {
    gd_attitude_end_loop(a);
  }
}

/* Does the second half of the update of a hypothesis. */
static inline void gd_attitude_do_second_half(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  gd_attitude_hypothesis *h = gd_attitude_at(a, job->index - 1);
  const gd_real noise_var = gd_max(GD_ATTITUDE_GYRO_NOISE * GD_ATTITUDE_GYRO_NOISE, a->noise_var);
  if (job->stage == GD_ATTITUDE_CARRY) {
    gd_attitude_predict_covariance(h->cov, &job->transition, &job->block, a->c.walk_var, noise_var);
    job->stage = GD_ATTITUDE_PREDICT;
  } else {
    gd_attitude_measure_standing(h, job->error, &job->candidate);
    job->stage = job->stage == GD_ATTITUDE_STAND ? GD_ATTITUDE_REPEAT : GD_ATTITUDE_BRANCH;
  }
}

/* Does up to one merge. */
static inline void gd_attitude_merge_next(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  if (job->index + 1 >= a->sum.count) {
    gd_attitude_prune(&a->sum);
    if (job->after == GD_ATTITUDE_LEARN && !job->is_continued) {
      gd_attitude_begin_segment(a, &job->candidate);
    }
    gd_attitude_go_to(job, job->after);
    return;
  }
  job->later = (uint8_t)gd_attitude_merge_with_later(&a->sum, job->index, job->later);
  if (job->later >= a->sum.count) {
    job->index++;
    job->later = (uint8_t)(job->index + 1);
  }
}

/* Ends a gap: the estimate is written, and the sample after it begins a block. */
static inline void gd_attitude_end_gap(gd_attitude *a) {
  gd_attitude_go_to(&a->job, GD_ATTITUDE_IDLE);
  a->job.is_at_gap = a->job.is_guess = 0;
  gd_attitude_publish(a);
  gd_attitude_next_block(&a->block, gd_attitude_at(a, 0)->bias, gd_attitude_at(a, 0)->scale);
  gd_attitude_count_correction(a);
  gd_attitude_note_sample(a, a->job.still, a->job.temp_c);
}

/* Does the next portion. */
static inline void gd_attitude_do_portion(gd_attitude *a) {
  switch (a->job.stage) {
    case GD_ATTITUDE_WIDEN:
      gd_attitude_widen_all(a);
      break;
    case GD_ATTITUDE_FIND:
      gd_attitude_find_candidate(a);
      break;
    case GD_ATTITUDE_CARRY:
    case GD_ATTITUDE_STAND_BRANCH:
    case GD_ATTITUDE_STAND:
      gd_attitude_do_second_half(a);
      break;
    case GD_ATTITUDE_MERGE:
      gd_attitude_merge_next(a);
      break;
    case GD_ATTITUDE_LEARN:
      gd_attitude_learn(a);
      break;
    case GD_ATTITUDE_PUBLISH:
      gd_attitude_finish(a);
      break;
    case GD_ATTITUDE_REOPEN:
      gd_attitude_end_gap(a);
      break;
    default:
      gd_attitude_do_next_hypothesis(a);
      break;
  }
}

#endif
