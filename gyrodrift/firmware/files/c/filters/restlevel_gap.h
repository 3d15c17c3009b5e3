/* Restlevel: a gap in the samples. Twin of restlevel/gap.py. */
#ifndef GD_RESTLEVEL_GAP_H
#define GD_RESTLEVEL_GAP_H

#include "restlevel_portions.h"

#if GD_RESTLEVEL_GAPS

/* Ends the block and the segment; nothing of them goes on after the gap. */
static inline void gd_rl_forget_block(gd_restlevel *s, double step_s) {
  gd_rl_forget_segments(s);
#if GD_RESTLEVEL_AUXILIARY
  s->lived_s += s->GD_RL_SUMS.seconds + step_s;
  s->witness.was_certain = 0;
#else
  (void)step_s;
#endif
  memset(&s->GD_RL_SUMS, 0, sizeof s->GD_RL_SUMS);
}

/* Goes over a gap to a sample that comes `step_s` later with this rate. The sample then begins a block. */
static inline void gd_rl_pass_gap(gd_restlevel *s, double step_s, gd_real rate_dps) {
  const gd_real seconds = gd_gap_length_s(step_s);
  const gd_real gap_var = gd_turn_var(seconds, s->rate_dps + rate_dps - GD_R(2.0) * s->bias_dps);
  const gd_real drift_var = gd_drift_var(seconds, s->c.rate_walk_var, s->c.rate_ramp_dps_s, s->c.turn_on_var);
  const gd_real angle_walk_var = gd_max(GD_R(0.0), s->noise.angle_walk_var); /* unknown in the first block */
  uint8_t k;
  gd_rl_predict(s, s->GD_RL_SUMS.angle_deg, (gd_real)s->GD_RL_SUMS.seconds, angle_walk_var);
  for (k = 0; k < s->stored; ++k) {
    gd_rl_hypothesis *h = &s->hypotheses[k];
    h->is_at_rest = h->was_at_rest = 0;
    h->yaw_var += gap_var;
    h->bias_var += drift_var;
  }
  gd_rl_forget_block(s, step_s);
  gd_rl_collapse(s);
  if (gd_may_have_restarted(s->longest_step_s, step_s) && s->c.turn_on_var > GD_R(0.0)) {
    gd_rl_reopen(s);
  }
  s->longest_step_s = gd_longest_after_gap_s(s->longest_step_s, step_s);
  s->rate_dps = rate_dps;
}

/* Takes the next step as a gap, whatever its length is: samples are missing. */
static inline void gd_restlevel_gap(gd_restlevel *s) {
  if (s->samples > 0 && s->longest_step_s > GD_TOLD_GAP) {
    s->longest_step_s = GD_TOLD_GAP;
  }
}

/* Takes the next step as a restart of the gyro: its bias is another one, and the next sample may have any time. */
static inline void gd_restlevel_restarted(gd_restlevel *s) {
  if (s->samples > 0) {
    s->longest_step_s = GD_TOLD_RESTART;
  }
}

#endif

#endif
