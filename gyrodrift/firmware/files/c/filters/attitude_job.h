/* Attitude filter: the work at the end of a block and at a gap, in portions.

   A portion is half an update of one hypothesis, or what all of them share. Samples that come meanwhile wait in a
   queue: the rotation of the next block begins with the bias that this work finds. */
#ifndef GD_ATTITUDE_JOB_H
#define GD_ATTITUDE_JOB_H

#include "attitude_gap.h"

enum {
  GD_ATTITUDE_IDLE,
  GD_ATTITUDE_PREDICT, /* for each hypothesis, and then its covariance */
  GD_ATTITUDE_CARRY,
  GD_ATTITUDE_WIDEN,
  GD_ATTITUDE_BOUND, /* for each hypothesis */
  GD_ATTITUDE_FIND,
  GD_ATTITUDE_WEIGH,   /* for each hypothesis */
  GD_ATTITUDE_BRANCH,  /* for each of the branches */
  GD_ATTITUDE_REPEAT,  /* for each hypothesis of rest */
  GD_ATTITUDE_STAND_BRANCH, /* second half of both */
  GD_ATTITUDE_STAND,
  GD_ATTITUDE_MERGE,   /* for each merge */
  GD_ATTITUDE_LEARN,
  GD_ATTITUDE_AID, /* for each hypothesis, by a second sensor */
  GD_ATTITUDE_PUBLISH,
  GD_ATTITUDE_REOPEN /* the end of a gap */
};

static inline void gd_attitude_go_to(gd_attitude_job *job, int stage) {
  job->stage = (uint8_t)stage;
  job->index = 0;
}

/* Begin to merge hypotheses; then comes the stage `after`. */
static inline void gd_attitude_begin_merge(gd_attitude *a, int after) {
  gd_attitude_sort(&a->sum);
  a->job.after = (uint8_t)after;
  a->job.later = 1;
  gd_attitude_go_to(&a->job, GD_ATTITUDE_MERGE);
}

/* Begin the work of the block that ends with the last sample. Without acceleration its specific force is gravity
   alone. */
static inline void gd_attitude_begin_job(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  int i;
  job->waits = job->is_divided;
  job->is_divided = 0;
  gd_attitude_integrals_of(&job->block, &a->block);
  a->lived_s += (double)job->block.seconds;
  job->is_blind = a->block.is_clipped || !gd_are_finite(job->block.velocity);
  job->heading_deg = a->heading_deg;
  if (!job->is_at_gap) {
    job->before_deg = a->heading_deg;
    job->turns_before = a->turns;
  }
  memcpy(job->usable_velocity, job->block.velocity, sizeof job->usable_velocity);
  if (job->is_blind) {
    gd_up_in_sensor(job->usable_velocity, gd_attitude_at(a, 0)->q);
    for (i = 0; i < 3; i++) {
      job->usable_velocity[i] *= GD_ATTITUDE_GRAVITY * job->block.seconds;
    }
  }
  gd_attitude_go_to(job, GD_ATTITUDE_PREDICT);
}

/* Widen the covariances, and level the attitude at the start. */
static inline void gd_attitude_widen_all(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  gd_attitude_follow_temperature(a, job->block.seconds);
  gd_attitude_widen_by_tilt(a);
  gd_attitude_widen_by_motion(a, job->block.seconds);
  if (job->is_blind) {
    gd_attitude_forget_velocity(a);
    gd_attitude_go_to(job, GD_ATTITUDE_FIND);
  } else {
    gd_attitude_find_lost_tilt(a, &job->block);
    gd_attitude_level_start(a, &job->block);
    gd_attitude_begin_velocity(a, job);
    gd_attitude_go_to(job, GD_ATTITUDE_BOUND);
  }
}

/* Find a rest candidate that ends with this block. */
static inline void gd_attitude_find_candidate(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  gd_attitude_candidate *m = &job->candidate;
  const int is_resting = a->segment.blocks > 0 || gd_attitude_at(a, 0)->knows_bias;
  int goes_on;
  gd_attitude_add_block(&a->windows, &job->block);
  if (a->block.moving > 0) {
    a->windows.blocks = 0;
  }
  job->is_repeated = job->was_brief = 0;
  job->is_certain = gd_attitude_certain_rest(m, a) != 0;
  job->is_found = job->is_certain || gd_attitude_find_rest(m, &a->windows, a->c.limits, is_resting);
  goes_on = job->is_found && gd_attitude_continues(a, m);
  if (job->is_found && !job->is_certain && a->segment.blocks > 0 && !goes_on) {
    gd_attitude_end_level(a);
    job->is_found = 0;
  } else if (job->is_found && !job->is_certain && a->segment.blocks == 0 && gd_attitude_slopes(a, m)) {
    job->is_found = 0;
  }
  job->is_continued = goes_on && job->is_found;
  gd_attitude_go_to(job, GD_ATTITUDE_LEARN);
  if (!job->is_found) {
    gd_attitude_end_segment(a);
  } else if (!goes_on) {
    job->odds = gd_attitude_prior_odds(a, m, job->is_certain);
    gd_attitude_go_to(job, GD_ATTITUDE_WEIGH);
  } else if (gd_attitude_continue_segment(a, m, &job->overlap)) {
    gd_attitude_go_to(job, GD_ATTITUDE_REPEAT);
  }
}

/* Learn from the candidate once the hypotheses are updated by it. */
static inline void gd_attitude_learn(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  if (job->was_brief) {
    gd_attitude_begin_slide(a);
  }
  if (job->is_repeated) {
    gd_attitude_follow_bias(a, (double)GD_ATTITUDE_UPDATE_BLOCKS * a->c.block_s);
  }
  if (job->is_certain) {
    gd_attitude_keep_rests(&a->sum);
  }
  if (job->is_found && a->rest_probability > GD_MAJORITY) {
    gd_attitude_learn_noise(a, &job->candidate);
  }
  gd_attitude_drop_wrong_memory(a);
  gd_attitude_go_to(job, a->aid.variance > GD_R(0.0) ? GD_ATTITUDE_AID : GD_ATTITUDE_PUBLISH);
}

/* Stores a step of yaw that is no motion, and counts it if it is large. */
static inline void gd_attitude_count_correction(gd_attitude *a) {
  const gd_real step_deg = a->heading_deg - a->job.before_deg + GD_R(360.0) * (gd_real)(a->turns - a->job.turns_before);
  a->correction_deg += step_deg;
  if (GD_ABS(step_deg) > GD_CORRECTION_DEG && a->corrections < UINT16_MAX) {
    ++a->corrections;
  }
}

/* Counts a sample and the report of a rest sensor with it, and takes its temperature. */
static inline void gd_attitude_note_sample(gd_attitude *a, gd_real still, gd_real temp_c) {
  a->temp_c = gd_is_temperature(temp_c) ? temp_c : a->temp_c;
  gd_count(&a->samples);
  a->block.still += still >= 1 && still <= 1;
  a->block.moving += still < 1 || still > 1;
}

/* Write the estimate, and begin the next block. */
static inline void gd_attitude_finish(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  int i;
  gd_attitude_go_to(job, GD_ATTITUDE_IDLE);
  job->is_guess = 0;
  if (!gd_attitude_is_whole(a)) {
    gd_attitude_begin_again(a, job->heading_deg);
  } else {
    gd_attitude_bring_forward(&a->sum);
    for (i = 0; i < a->sum.count; i++) {
      gd_attitude_at(a, i)->yaw_deg = gd_unwrapped_deg(gd_attitude_at(a, i)->yaw_deg, gd_attitude_at(a, i)->q);
    }
    gd_attitude_count_turns(a);
    gd_attitude_publish(a);
    gd_attitude_learn_when_sure(a, job->block.seconds);
    gd_attitude_next_block(&a->block, gd_attitude_at(a, 0)->bias, gd_attitude_at(a, 0)->scale);
  }
  if (!job->is_at_gap) {
    gd_attitude_count_correction(a);
  }
}

/* End a stage once all hypotheses are through. */
static inline void gd_attitude_end_loop(gd_attitude *a) {
  gd_attitude_job *job = &a->job;
  switch (job->stage) {
    case GD_ATTITUDE_PREDICT:
      gd_attitude_go_to(job, GD_ATTITUDE_WIDEN);
      break;
    case GD_ATTITUDE_BOUND:
      gd_attitude_weigh_velocity(a, job);
      gd_attitude_go_to(job, GD_ATTITUDE_FIND);
      break;
    case GD_ATTITUDE_WEIGH:
      gd_attitude_branch(a, job);
      gd_attitude_go_to(job, GD_ATTITUDE_BRANCH);
      break;
    case GD_ATTITUDE_BRANCH:
      gd_attitude_begin_merge(a, GD_ATTITUDE_LEARN);
      break;
    case GD_ATTITUDE_AID:
      gd_attitude_normalize(&a->sum);
      a->aid.variance = GD_R(0.0);
      gd_attitude_go_to(job, GD_ATTITUDE_PUBLISH);
      break;
    default:
      if (gd_attitude_rests_first(a) > 0) {
        gd_attitude_begin_merge(a, GD_ATTITUDE_LEARN);
      } else {
        gd_attitude_go_to(job, GD_ATTITUDE_LEARN);
      }
      break;
  }
}

#endif
