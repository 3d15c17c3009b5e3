/* Attitude filter: rest candidates: windows of blocks in which gyro and accelerometer keep their means.

   Skog et al., Zero-Velocity Detection (SHOE), IEEE Trans. Biomedical Engineering 57(11), 2010. */
#ifndef GD_ATTITUDE_RESTS_H
#define GD_ATTITUDE_RESTS_H

#include "attitude_matrix.h"

/* Limits of the standard deviation of block means in a quiet rest, rad/s and m/s^2. */
#define GD_ATTITUDE_GYRO_SPREAD (GD_R(0.15) * GD_ATTITUDE_RAD)
#define GD_ATTITUDE_ACCEL_SPREAD GD_R(0.07)
/* Largest distance of the mean acceleration from gravity, m/s^2: biases of cheap parts. */
#define GD_ATTITUDE_GRAVITY_GATE GD_R(0.8)
/* Highest bias that a brief rest shows, rad/s, and likewise at power-on, where rests are more frequent. */
#define GD_ATTITUDE_FASTEST_BRIEF (GD_R(2.0) * GD_ATTITUDE_RAD)
#define GD_ATTITUDE_FASTEST_START (GD_R(4.0) * GD_ATTITUDE_RAD)

/* Blocks of a quiet and of a brief rest. A brief rest is the moment after power-on before a hand takes the device. */
enum { GD_ATTITUDE_QUIET_BLOCKS = 10, GD_ATTITUDE_BRIEF_BLOCKS = 4 };

/* Kinds of rest in the order of the search: quiet, brief, noisy and long noisy ones. */
static inline gd_attitude_kind gd_attitude_kind_of(int i) {
  static const gd_attitude_kind kinds[4] = {
      {GD_ATTITUDE_QUIET_BLOCKS, GD_R(1.0), GD_R(1.0), GD_R(1.0)},
      {GD_ATTITUDE_BRIEF_BLOCKS, GD_R(0.4), GD_R(0.5), GD_R(4.0)},
      {20, GD_R(2.5), GD_R(2.0), GD_R(2.0)},
      {GD_ATTITUDE_LONGEST, GD_R(5.0), GD_R(3.0), GD_R(3.0)},
  };
  return kinds[i];
}

/* Keep the means of a block; windows do not reach over a change between blocks with and without acceleration. */
static inline void gd_attitude_add_block(gd_attitude_windows *w, const gd_attitude_integrals *block) {
  const uint8_t is_blind = !gd_are_finite(block->velocity);
  gd_real *row = w->rows[w->slot];
  int i;
  if (is_blind != w->is_blind) {
    w->blocks = 0;
    w->is_blind = is_blind;
  }
  for (i = 0; i < 3; i++) {
    row[i] = block->gyro[i] / GD_ATTITUDE_GYRO_SPREAD;
    row[3 + i] = is_blind ? GD_R(0.0) : block->accel[i] / GD_ATTITUDE_ACCEL_SPREAD;
  }
  w->slot = (uint8_t)((w->slot + 1) % GD_ATTITUDE_LONGEST);
  w->blocks += w->blocks < INT32_MAX;
  w->total += w->total < INT32_MAX;
}

/* Row after one of the ring. */
static inline const gd_real *gd_attitude_next_row(const gd_attitude_windows *w, const gd_real *row) {
  return row == w->rows[GD_ATTITUDE_LONGEST - 1] ? w->rows[0] : row + 6;
}

/* Means (6) of the last blocks, sums (6) of squared deviations, and absolute means of deviations in the newer half. */
static inline void gd_attitude_scatter(const gd_attitude_windows *w, int32_t blocks, gd_real mean[6],
                                       gd_real squares[6], gd_real newer[6]) {
  const gd_real *const oldest = w->rows[(w->slot + GD_ATTITUDE_LONGEST - blocks) % GD_ATTITUDE_LONGEST], *row = oldest;
  const int32_t half = blocks / 2;
  int32_t ago;
  int i;
  for (i = 0; i < 6; i++) {
    mean[i] = squares[i] = newer[i] = 0;
  }
  for (ago = blocks - 1; ago >= 0; ago--, row = gd_attitude_next_row(w, row)) {
    for (i = 0; i < 6; i++) {
      mean[i] += row[i];
    }
  }
  for (i = 0; i < 6; i++) {
    mean[i] /= (gd_real)blocks;
  }
  for (ago = blocks - 1, row = oldest; ago >= 0; ago--, row = gd_attitude_next_row(w, row)) {
    for (i = 0; i < 6; i++) {
      const gd_real deviation = row[i] - mean[i];
      squares[i] += deviation * deviation;
      newer[i] += ago < half ? deviation : GD_R(0.0);
    }
  }
  for (i = 0; i < 6; i++) {
    newer[i] = GD_ABS(newer[i] / (gd_real)half);
  }
}

/* The window of this kind that ends now, if its block means scatter little and its newer half has the mean of all. */
static inline int gd_attitude_last_window(gd_attitude_candidate *out, const gd_attitude_windows *w,
                                          gd_attitude_kind kind, gd_real limits) {
  gd_real mean[6], squares[6], newer[6];
  const gd_real gyro = limits * kind.gyro, accel = limits * kind.accel, freedom = (gd_real)(kind.blocks - 1);
  int i;
  if (w->blocks < kind.blocks) {
    return 0;
  }
  gd_attitude_scatter(w, kind.blocks, mean, squares, newer);
  out->kind = kind;
  for (i = 0; i < 3; i++) {
    if (squares[i] / freedom > gyro * gyro || squares[3 + i] / freedom > accel * accel) {
      return 0;
    }
    if (newer[i] > GD_R(0.5) * gyro || newer[3 + i] > GD_R(0.5) * accel) {
      return 0;
    }
    out->gyro[i] = mean[i] * GD_ATTITUDE_GYRO_SPREAD;
    out->gyro_var[i] = squares[i] / freedom * (GD_ATTITUDE_GYRO_SPREAD * GD_ATTITUDE_GYRO_SPREAD);
    out->accel[i] = mean[3 + i] * GD_ATTITUDE_ACCEL_SPREAD;
  }
  return 1;
}

/* Whether the last four blocks alone scatter too much for a window of this kind: most blocks end here. */
static inline int gd_attitude_scatters(const gd_real squares[6], gd_attitude_kind kind, gd_real limits) {
  const gd_real freedom = limits * limits * (gd_real)(kind.blocks - 1);
  return gd_largest(squares) > freedom * kind.gyro * kind.gyro ||
         gd_largest(&squares[3]) > freedom * kind.accel * kind.accel;
}

/* Whether a candidate has gravity alone, and a rate that a brief rest may show. */
static inline int gd_attitude_is_plausible(const gd_attitude_windows *w, const gd_attitude_candidate *m) {
  const gd_real size = GD_SQRT(gd_dot(m->accel, m->accel));
  const gd_real fastest =
      w->total <= GD_ATTITUDE_BRIEF_BLOCKS + 1 ? GD_ATTITUDE_FASTEST_START : GD_ATTITUDE_FASTEST_BRIEF;
  if (!w->is_blind && !(GD_ABS(size - GD_ATTITUDE_GRAVITY) < GD_ATTITUDE_GRAVITY_GATE)) {
    return 0;
  }
  return m->kind.blocks != GD_ATTITUDE_BRIEF_BLOCKS || gd_largest(m->gyro) <= fastest;
}

/* First kind of rest whose window, which ends now, looks still; 0 without any. Without acceleration only a quiet rest
   counts. `limits` is a factor on all limits. */
static inline int gd_attitude_find_rest(gd_attitude_candidate *out, const gd_attitude_windows *w, gd_real limits,
                                        int is_resting) {
  gd_real mean[6], squares[6], newer[6];
  int i;
  if (w->blocks < GD_ATTITUDE_BRIEF_BLOCKS) {
    return 0;
  }
  gd_attitude_scatter(w, GD_ATTITUDE_BRIEF_BLOCKS, mean, squares, newer);
  for (i = 0; i < (w->is_blind ? 1 : 4); i++) {
    const gd_attitude_kind kind = gd_attitude_kind_of(i);
    if ((kind.blocks == GD_ATTITUDE_BRIEF_BLOCKS && is_resting) || gd_attitude_scatters(squares, kind, limits)) {
      continue;
    }
    if (gd_attitude_last_window(out, w, kind, limits) && gd_attitude_is_plausible(w, out)) {
      return 1;
    }
  }
  return 0;
}

#endif
