/* Attitude filter: segments: runs of rest candidates with the same mean rates, and the branches at their start. */
#ifndef GD_ATTITUDE_SEGMENTS_H
#define GD_ATTITUDE_SEGMENTS_H

#include "attitude_vertical.h"
#include "attitude_witness.h"

/* Blocks between two updates of a rest; blocks by which a rest may begin after the first sample and still be one from
   the start; blocks after which a segment with the same rates is another one. */
enum { GD_ATTITUDE_UPDATE_BLOCKS = 10, GD_ATTITUDE_START_BLOCKS = 4, GD_ATTITUDE_RESUME_BLOCKS = 11 };
/* Prior odds of a rest that a witness reports, and that fits the bias. */
#define GD_ATTITUDE_CERTAIN_ODDS GD_R(1e9)
/* Least angle random walk of a gyro, rad/sqrt(s), and the weight of a block at rest in it. */
#define GD_ATTITUDE_GYRO_NOISE (GD_R(0.02) * GD_ATTITUDE_RAD)
#define GD_ATTITUDE_NOISE_SHARE GD_R(0.05)
/* Odds of a rest by an accelerometer as quiet as the gyro: vehicles in a bend shake. */
#define GD_ATTITUDE_QUIET_ODDS GD_R(4.0)

/* Raise the probability of rests as a segment grows longer than even turns last. */
static inline void gd_attitude_weigh_duration(gd_attitude *a, gd_real before_s, gd_real now_s) {
  const gd_real ratio = gd_duration_odds(now_s) / gd_duration_odds(before_s);
  int i;
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_at(a, i)->weight *= gd_attitude_at(a, i)->regime == GD_ATTITUDE_REST ? ratio : GD_R(1.0);
  }
  gd_attitude_normalize(&a->sum);
}

/* Whether the rates of a later window fit the bias of the first hypothesis of rest, before a gradual end changed it. */
static inline int gd_attitude_is_same_rest(gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_real error = GD_ATTITUDE_SAME_RATE * GD_ATTITUDE_RAD;
  gd_real spread[9], inverse[9], off[3], scatter[3];
  int i, k;
  gd_attitude_scatter_variances(scatter, m);
  for (i = 0; i < a->sum.count; i++) {
    const gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    if (h->regime == GD_ATTITUDE_REST) {
      gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
      for (k = 0; k < 3; k++) {
        spread[4 * k] += scatter[k] + error * error;
        off[k] = m->gyro[k] - h->bias[k] + a->segment.undone * a->segment.up[k];
      }
      gd_invert(inverse, 0, spread);
      return gd_quadratic(inverse, off) <= GD_ATTITUDE_GATE;
    }
  }
  return 1;
}

/* Follow the angle random walk of the gyro by the scatter of block means at rest. */
static inline void gd_attitude_learn_noise(gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_real mean = (m->gyro_var[0] + m->gyro_var[1] + m->gyro_var[2]) / GD_R(3.0);
  a->noise_var += GD_ATTITUDE_NOISE_SHARE * (mean * (gd_real)a->c.block_s - a->noise_var);
}

/* Whether the last segment has just ended gradually: the device has not moved since but for a slow turn. */
static inline int gd_attitude_left_gradually(const gd_attitude *a) {
  return a->segment.ended_gradually && a->segment.ago < GD_ATTITUDE_RESUME_BLOCKS;
}

/* Prior odds of a new candidate. A segment after one that ended gradually has `rest_share` alone: the accelerometer was
   quiet all the time. */
static inline gd_real gd_attitude_prior_odds(const gd_attitude *a, const gd_attitude_candidate *m, int is_certain) {
  const int is_from_start = a->windows.total <= m->kind.blocks + GD_ATTITUDE_START_BLOCKS;
  const int is_at_first = is_from_start && !a->has_restarted; /* with `still_start` alone */
  const gd_real factor = is_at_first || gd_attitude_left_gradually(a) ? GD_R(1.0) : GD_ATTITUDE_QUIET_ODDS;
  const gd_real odds = (is_from_start ? a->c.start_odds : a->c.rest_odds) * factor;
  return is_certain ? GD_ATTITUDE_CERTAIN_ODDS : odds;
}

/* Begin a segment by a candidate that has branched all hypotheses. */
static inline void gd_attitude_begin_segment(gd_attitude *a, const gd_attitude_candidate *m) {
  gd_attitude_segment *segment = &a->segment;
  segment->blocks = m->kind.blocks;
  segment->since = segment->ago = 0;
  segment->seconds = (gd_real)m->kind.blocks * (gd_real)a->c.block_s;
  memcpy(segment->gyro, m->gyro, sizeof m->gyro);
  gd_attitude_begin_level(a, m);
}

/* End the segment; after some blocks it cannot resume, and all hypotheses are undecided. */
static inline void gd_attitude_end_segment(gd_attitude *a) {
  gd_attitude_segment *segment = &a->segment;
  int i;
  if (segment->blocks > 0) {
    segment->ago = 1;
  } else {
    segment->ago += segment->ago < INT32_MAX;
  }
  segment->blocks = 0;
  for (i = 0; segment->ago == GD_ATTITUDE_RESUME_BLOCKS && i < a->sum.count; i++) {
    gd_attitude_at(a, i)->regime = GD_ATTITUDE_UNDECIDED;
  }
}

/* Whether a window has the rates of the present or the last segment, and the bias of its rest. */
static inline int gd_attitude_continues(gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_attitude_segment *segment = &a->segment;
  const gd_real limit = gd_max(m->kind.gyro, GD_R(1.0)) * GD_ATTITUDE_GYRO_SPREAD;
  gd_real off[3];
  int i, may_drift = 0;
  if (!(segment->seconds > 0) || (segment->blocks == 0 && segment->ago >= GD_ATTITUDE_RESUME_BLOCKS)) {
    return 0;
  }
  if (segment->blocks > 0 ? gd_attitude_leaves_level(a, m) : !gd_attitude_resumes_level(a, m)) {
    return 0;
  }
  for (i = 0; i < 3; i++) {
    off[i] = m->gyro[i] - segment->gyro[i];
  }
  for (i = 0; gd_attitude_is_quiet(m) && i < a->sum.count; i++) {
    may_drift = may_drift || gd_attitude_at(a, i)->regime == GD_ATTITUDE_REST;
  }
  return (may_drift || gd_largest(off) < GD_R(2.0) * limit) && gd_attitude_is_same_rest(a, m);
}

/* Widen the biases of rests by half of the fastest drift since the last update. */
static inline void gd_attitude_let_drift(gd_attitude *a) {
  const gd_real drift = GD_R(0.5) * a->c.drift_rate * (gd_real)a->segment.since * (gd_real)a->c.block_s;
  int i;
  for (i = 0; i < a->sum.count; i++) {
    if (gd_attitude_at(a, i)->regime == GD_ATTITUDE_REST) {
      gd_add_variance(gd_attitude_at(a, i)->cov, GD_ATTITUDE_BIAS, drift * drift);
    }
  }
}

/* Count the blocks since the last update in the duration of the segment, and weigh it. */
static inline void gd_attitude_lengthen(gd_attitude *a) {
  gd_attitude_segment *segment = &a->segment;
  const gd_real seconds = segment->seconds + (gd_real)segment->since * (gd_real)a->c.block_s;
  gd_attitude_weigh_duration(a, segment->seconds, seconds);
  segment->seconds = seconds;
  segment->since = 0;
}

/* Move the hypotheses of rest to the front of the list; returns their number. */
static inline int gd_attitude_rests_first(gd_attitude *a) {
  gd_attitude_sum *sum = &a->sum;
  uint8_t others[GD_ATTITUDE_SLOTS];
  int i, rest_count = 0, other_count = 0;
  for (i = 0; i < sum->count; i++) {
    if (gd_attitude_at(a, i)->regime == GD_ATTITUDE_REST) {
      sum->order[rest_count++] = sum->order[i];
    } else {
      others[other_count++] = sum->order[i];
    }
  }
  for (i = 0; i < other_count; i++) {
    sum->order[rest_count + i] = others[i];
  }
  return rest_count;
}

/* Resume or lengthen a segment by a candidate that ends with this block; returns whether its rests are measured again,
   with `overlap`. */
static inline int gd_attitude_continue_segment(gd_attitude *a, const gd_attitude_candidate *m, gd_real *overlap) {
  gd_attitude_segment *segment = &a->segment;
  const int resumes = segment->blocks == 0;
  segment->blocks = m->kind.blocks;
  segment->since = resumes ? 0 : segment->since + 1;
  *overlap = GD_R(1.0);
  if (resumes) {
    a->job.was_brief = segment->level_blocks < GD_ATTITUDE_QUIET_BLOCKS;
    gd_attitude_resume_level(a, m);
    return 1;
  }
  gd_attitude_follow_level(a);
  if (segment->since < GD_ATTITUDE_UPDATE_BLOCKS) {
    return 0;
  }
  *overlap = gd_max(GD_R(1.0), (gd_real)m->kind.blocks / (gd_real)GD_ATTITUDE_QUIET_BLOCKS);
  gd_attitude_let_drift(a);
  gd_attitude_lengthen(a);
  a->job.is_repeated = 1;
  return 1;
}

#endif
