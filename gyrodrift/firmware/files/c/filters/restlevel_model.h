/* Restlevel: coefficients and state. Twin of restlevel/model.py. */
#ifndef GD_RESTLEVEL_MODEL_H
#define GD_RESTLEVEL_MODEL_H

#include "gaps.h"
#include "parameters.h"
#include "parts.h"
#include "restlevel_bias_state.h"
#include "restlevel_rate_state.h"

/* Hypotheses that are kept from one segment to the next, 2 to 8. Fewer need less memory, and more of them remember a
   rest that was in doubt: docs/firmware/filter.md says what each number costs. */
#ifndef GD_RESTLEVEL_HYPOTHESES
#ifdef __AVR__
#define GD_RESTLEVEL_HYPOTHESES 4 /* leaves RAM of an ATmega328P for the stack */
#else
#define GD_RESTLEVEL_HYPOTHESES 6
#endif
#endif
#if GD_RESTLEVEL_HYPOTHESES < 2 || GD_RESTLEVEL_HYPOTHESES > 8
#error "GD_RESTLEVEL_HYPOTHESES must be 2 to 8"
#endif

/* 0 leaves out the external rest sensor and the temperature, the bias of an earlier run, rests with a running engine,
   or the rule for gaps and restarts, without which the rate is integrated over a gap: less code and memory, and the
   same results otherwise. */
#ifdef __AVR__
#define GD_RL_DEFAULT_PARTS 0
#else
#define GD_RL_DEFAULT_PARTS 1
#endif
#ifndef GD_RESTLEVEL_AUXILIARY
#define GD_RESTLEVEL_AUXILIARY GD_RL_DEFAULT_PARTS
#endif
#ifndef GD_RESTLEVEL_MEMORY
#define GD_RESTLEVEL_MEMORY (GD_RL_DEFAULT_PARTS && GD_RESTLEVEL_HYPOTHESES >= 4) /* it begins with one more */
#endif
#ifndef GD_RESTLEVEL_GAPS
#define GD_RESTLEVEL_GAPS GD_RL_DEFAULT_PARTS
#endif

#ifndef GD_RESTLEVEL_LOUD
#define GD_RESTLEVEL_LOUD GD_RL_DEFAULT_PARTS
#endif

#define GD_MAX_HYPOTHESES GD_RESTLEVEL_HYPOTHESES
#define GD_RL_FIRST (GD_PARTS + (GD_RESTLEVEL_MEMORY ? 1 : 0)) /* the filter begins with so many */
#define GD_RL_STORED (GD_MAX_HYPOTHESES < GD_RL_FIRST ? GD_RL_FIRST : GD_MAX_HYPOTHESES)

#define GD_UNKNOWN_C GD_UNSAID_C
#define GD_COLDEST_C GD_R(-100.0) /* temperatures out of this range are ignored */
#define GD_WARMEST_C GD_R(200.0)

/* Values that follow from the parameters alone. */
typedef struct {
  double window_s;
  gd_real stationarity_sigmas;
  gd_real turn_on_var;
  gd_real rate_walk_var;
  gd_real rate_ramp_dps_s;
  gd_real start_odds, rest_odds;
  gd_real scale_sigma;
} gd_rl_coefficients;

/* State; a copy of it saves the filter. The results stand first. */
typedef struct {
  gd_real yaw_deg, yaw_sigma_deg;
  gd_real bias_dps, bias_sigma_dps;
  gd_real rest_probability, confidence;
  uint32_t samples, rejected;
  gd_real correction_deg; /* step of yaw in the last sample that is no motion: a change of the estimate */
  uint8_t corrections;    /* number of those over 1 deg, up to 255 */

  union { /* time of the last sample, by the clock in use */
    double t_s;
    uint32_t t_us;
  };
#if GD_RESTLEVEL_GAPS
  double longest_step_s; /* longest step that is no gap; see gaps.h */
#endif
  gd_rl_block block;
  gd_real rate_dps;
  gd_real base_deg; /* with floats, yaw is kept near 0; this is the angle subtracted so far */
  gd_real start_yaw_deg, travelled_deg, travelled_s; /* since the first sample or the last zero */
  gd_rl_coefficients c;
#if GD_RESTLEVEL_MEMORY
  gd_rl_remembered remembered;
#endif
  gd_rl_noise noise;
#if GD_RESTLEVEL_LOUD
  gd_rl_loud loud;
#endif
  gd_rl_segment segment;
  gd_rl_ended ended;
  gd_rl_moments moments;
  gd_rl_turns turns;
  gd_rl_wander wander;
#if GD_RESTLEVEL_AUXILIARY
  gd_real temp_c; /* GD_UNKNOWN_C until there is one */
  double lived_s; /* since the first sample */
  double sure_s;  /* length of the present sure rest */
  gd_rl_line line;
  gd_rl_witness witness;
#endif
  gd_rl_hypothesis hypotheses[GD_RL_STORED]; /* `stored` of them, in the order of their slots */
  uint8_t stored;
  uint8_t blocks; /* complete blocks, up to 255 */
} gd_restlevel;

#endif
