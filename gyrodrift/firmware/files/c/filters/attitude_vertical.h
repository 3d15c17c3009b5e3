/* Attitude filter: the rate of a segment about the vertical, by the rules of one axis. Twin of attitude/vertical.py.

   In a level turn gravity stands still, as in a rest, so three axes know no more than one. A rate that leaves the level
   of a rest slowly is a turn that begins. The bias is then the one before it began to slide. */
#ifndef GD_ATTITUDE_VERTICAL_H
#define GD_ATTITUDE_VERTICAL_H

#include "attitude_mixture.h"
#include "attitude_regimes.h"
#include "restlevel_durations.h"
#include "restlevel_segments.h"
#include "restlevel_slide.h"

/* Newest blocks that are compared with a segment: a block of one axis. */
enum { GD_ATTITUDE_NEWEST = 3 };

/* Mean rate about a direction, rad/s, over some blocks that end `ago` blocks before the newest one. */
static inline gd_real gd_attitude_mean_vertical(const gd_attitude_windows *w, int32_t ago, int32_t blocks,
                                            const gd_real up[3]) {
  const gd_real *row = w->rows[(w->slot + 2 * GD_ATTITUDE_LONGEST - ago - blocks) % GD_ATTITUDE_LONGEST];
  gd_real sum[3] = {0, 0, 0};
  int32_t k;
  int i;
  for (k = 0; k < blocks; k++, row = gd_attitude_next_row(w, row)) {
    for (i = 0; i < 3; i++) {
      sum[i] += row[i];
    }
  }
  return GD_ATTITUDE_GYRO_SPREAD * gd_dot(sum, up) / (gd_real)blocks;
}

/* Variance of the difference of two mean rates, (rad/s)^2. `shares` is the sum of the inverse numbers of their blocks,
   and the bias drifts for `apart` blocks between them. */
static inline gd_real gd_attitude_level_var(const gd_attitude *a, gd_real shares, gd_real apart) {
  const gd_real drift = a->c.drift_rate * apart * (gd_real)a->c.block_s;
  const gd_real flicker = GD_ATTITUDE_SAME_RATE * GD_ATTITUDE_RAD;
  return a->noise_var / (gd_real)a->c.block_s * shares + drift * drift + flicker * flicker;
}

static inline int gd_attitude_is_quiet(const gd_attitude_candidate *m) {
  return m->kind.blocks == GD_ATTITUDE_QUIET_BLOCKS;
}

/* Whether the newest blocks of a quiet window leave the level of the present segment. */
static inline int gd_attitude_leaves_level(const gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_attitude_segment *segment = &a->segment;
  const gd_real before = (gd_real)(segment->level_blocks - GD_ATTITUDE_NEWEST);
  gd_real off, variance;
  if (!gd_attitude_is_quiet(m) || before <= 0) {
    return 0;
  }
  off = gd_attitude_mean_vertical(&a->windows, 0, GD_ATTITUDE_NEWEST, segment->up) - segment->level;
  variance = gd_attitude_level_var(a, GD_R(1.0) / (gd_real)GD_ATTITUDE_NEWEST + GD_R(1.0) / before,
                                   GD_R(0.5) * (gd_real)segment->level_blocks);
  return off * off > GD_GATE_SIGMAS * GD_GATE_SIGMAS * variance;
}

/* Whether a quiet window has the level of the segment that ended before it. */
static inline int gd_attitude_resumes_level(const gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_attitude_segment *segment = &a->segment;
  const gd_real sigmas = segment->seconds >= (gd_real)GD_LONG_SEGMENT_S ? GD_LONG_GATE_SIGMAS : GD_GATE_SIGMAS;
  const gd_real off = gd_dot(m->gyro, segment->up) - segment->level;
  const gd_real shares = GD_R(1.0) / (gd_real)GD_ATTITUDE_QUIET_BLOCKS + GD_R(1.0) / (gd_real)GD_ATTITUDE_LONGEST;
  const gd_real variance =
      gd_attitude_level_var(a, shares, (gd_real)(segment->ago + GD_ATTITUDE_QUIET_BLOCKS));
  return !gd_attitude_is_quiet(m) || off * off < sigmas * sigmas * variance;
}

/* Whether the halves of a quiet window after a gradual end differ, so that its rate is no level. */
static inline int gd_attitude_slopes(const gd_attitude *a, const gd_attitude_candidate *m) {
  const gd_real norm = GD_SQRT(gd_dot(m->accel, m->accel));
  const int32_t half = GD_ATTITUDE_QUIET_BLOCKS / 2;
  gd_real up[3], slope;
  int i;
  if (!a->segment.ended_gradually || !gd_attitude_is_quiet(m) || !(norm > 0)) {
    return 0;
  }
  for (i = 0; i < 3; i++) {
    up[i] = m->accel[i] / norm;
  }
  slope = gd_attitude_mean_vertical(&a->windows, 0, half, up) - gd_attitude_mean_vertical(&a->windows, half, half, up);
  return slope * slope >
         GD_SLOPE_SIGMAS * GD_SLOPE_SIGMAS * GD_R(2.0) / (gd_real)half * a->noise_var / (gd_real)a->c.block_s;
}

/* Update the level of a segment that goes on with the newest block. */
static inline void gd_attitude_follow_level(gd_attitude *a) {
  gd_attitude_segment *segment = &a->segment;
  segment->level_blocks += segment->level_blocks < GD_ATTITUDE_LONGEST;
  segment->level = gd_attitude_mean_vertical(&a->windows, GD_ATTITUDE_NEWEST,
                                         segment->level_blocks - GD_ATTITUDE_NEWEST, segment->up);
}

/* Take the bias of the most probable rest about the vertical; 0 without a rest. */
static inline int gd_attitude_take_bias(gd_attitude *a) {
  gd_attitude_segment *segment = &a->segment;
  gd_real spread[9], by_up[3];
  int i;
  for (i = 0; i < a->sum.count; i++) {
    const gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    if (h->regime == GD_ATTITUDE_REST) {
      gd_diagonal_block(spread, h->cov, GD_ATTITUDE_BIAS);
      gd_times(by_up, spread, segment->up);
      segment->rest.bias_dps = gd_dot(h->bias, segment->up) / GD_ATTITUDE_RAD;
      segment->rest.bias_var = gd_dot(by_up, segment->up) / (GD_ATTITUDE_RAD * GD_ATTITUDE_RAD);
      return 1;
    }
  }
  return 0;
}

/* Begin the slide of the bias. */
static inline void gd_attitude_begin_slide(gd_attitude *a) {
  gd_attitude_take_bias(a);
  gd_rl_mark_safe(&a->segment.rest);
}

/* Begin the level and the slide of a segment. */
static inline void gd_attitude_begin_level(gd_attitude *a, const gd_attitude_candidate *m) {
  gd_attitude_segment *segment = &a->segment;
  const gd_real norm = GD_SQRT(gd_dot(m->accel, m->accel));
  int i;
  for (i = 0; i < 3; i++) {
    segment->up[i] = norm > 0 ? m->accel[i] / norm : GD_R(0.0);
  }
  segment->level = gd_dot(m->gyro, segment->up);
  segment->level_blocks = m->kind.blocks;
  segment->undone = 0;
  segment->ended_gradually = 0;
  memset(&segment->rest, 0, sizeof segment->rest);
  gd_attitude_begin_slide(a);
}

/* Update the slide of the bias after an update of a rest, `seconds` after the one before. */
static inline void gd_attitude_follow_bias(gd_attitude *a, double seconds) {
  if (gd_attitude_take_bias(a)) {
    gd_rl_follow_slide(a->c.drift_rate / GD_ATTITUDE_RAD, &a->segment.rest, seconds);
  }
}

/* Change the biases of rests about the vertical, rad/s, with their headings since the rest, and their odds. */
static inline void gd_attitude_turn_back(gd_attitude *a, gd_real change, gd_real odds) {
  int i, k;
  for (i = 0; i < a->sum.count; i++) {
    gd_attitude_hypothesis *h = gd_attitude_at(a, i);
    gd_real error[GD_ATTITUDE_STATES];
    if (h->regime == GD_ATTITUDE_REST) {
      memset(error, 0, sizeof error);
      for (k = 0; k < 3; k++) {
        error[GD_ATTITUDE_BIAS + k] = change * a->segment.up[k];
      }
      error[GD_ATTITUDE_HEADING] = -change * h->moving_s;
      gd_attitude_correct(h, error);
      h->weight *= odds;
    }
  }
  gd_attitude_normalize(&a->sum);
}

/* End a segment whose level the newest blocks have left; after a gradual end the bias is the safe one. The next window
   has blocks of the new level alone. */
static inline void gd_attitude_end_level(gd_attitude *a) {
  gd_attitude_segment *segment = &a->segment;
  gd_attitude_windows *w = &a->windows;
  const gd_real step =
      gd_attitude_mean_vertical(w, 0, GD_ATTITUDE_NEWEST, segment->up) -
      gd_attitude_mean_vertical(w, GD_ATTITUDE_NEWEST, GD_ATTITUDE_NEWEST, segment->up);
  const gd_real most = GD_GRADUAL_DPS_S * GD_ATTITUDE_RAD * (gd_real)GD_ATTITUDE_NEWEST * (gd_real)a->c.block_s;
  const int is_gradual = GD_ABS(step) < most;
  w->blocks = is_gradual ? GD_ATTITUDE_NEWEST : 1;
  if (is_gradual && gd_attitude_take_bias(a)) {
    segment->ended_gradually = 1;
    segment->undone = (segment->rest.safe.bias_dps - segment->rest.bias_dps) * GD_ATTITUDE_RAD;
    gd_attitude_turn_back(a, segment->undone, GD_GRADUAL_REST / GD_GRADUAL_SPIN);
  }
}

/* Resume a segment with its bias before a gradual end. */
static inline void gd_attitude_resume_level(gd_attitude *a, const gd_attitude_candidate *m) {
  gd_attitude_segment *segment = &a->segment;
  if (segment->ended_gradually) {
    gd_attitude_turn_back(a, -segment->undone, GD_GRADUAL_SPIN / GD_GRADUAL_REST);
  }
  segment->undone = 0;
  segment->ended_gradually = 0;
  segment->level_blocks = m->kind.blocks;
}

#endif
