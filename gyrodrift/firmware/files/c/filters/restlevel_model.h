/* Restlevel: coefficients and state. Twin of restlevel/model.py. */
#ifndef GD_RESTLEVEL_MODEL_H
#define GD_RESTLEVEL_MODEL_H

#include "aid.h"
#include "beliefs.h"
#include "contradictions.h"
#include "gaps.h"
#include "parameters.h"
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

/* 0 leaves out the external rest sensor and the temperature, the bias of an earlier run, the rule for gaps and
   restarts, without which the rate is integrated over a gap, headings and turn rates of other sensors, or rests with a
   running engine: less code and memory, and the same results otherwise. */
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
#ifndef GD_RESTLEVEL_AIDS
#define GD_RESTLEVEL_AIDS GD_RL_DEFAULT_PARTS
#endif
#ifndef GD_RESTLEVEL_VIBRATION
#define GD_RESTLEVEL_VIBRATION GD_RL_DEFAULT_PARTS
#endif

/* 1: gd_restlevel_work does the work of a block in portions. It keeps hypotheses that begin in the state; else they are
   on the stack of gd_restlevel_update, which then does all the work itself. */
#ifndef GD_RESTLEVEL_WORK
#ifdef __AVR__
#define GD_RESTLEVEL_WORK (GD_RESTLEVEL_HYPOTHESES <= 4) /* more leave an ATmega328P no RAM for it */
#else
#define GD_RESTLEVEL_WORK 1
#endif
#endif
#if GD_RESTLEVEL_WORK
#define GD_RL_SUMS sums /* of the present block, while `block` is worked on */
#else
#define GD_RL_SUMS block
#endif

#define GD_MAX_HYPOTHESES GD_RESTLEVEL_HYPOTHESES
#define GD_RL_FIRST (GD_PARTS + (GD_RESTLEVEL_MEMORY ? 1 : 0)) /* the filter begins with so many */
#define GD_RL_STORED (GD_MAX_HYPOTHESES < GD_RL_FIRST ? GD_RL_FIRST : GD_MAX_HYPOTHESES)

#define GD_TURN_DEG GD_R(30.0)    /* angle of a turn: errors of scale are equal within it */

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

/* Rests that begin, until they are merged and pruned with the rest of the hypotheses. */
typedef struct {
  gd_rl_hypothesis items[GD_RL_STORED];
  uint8_t count;
} gd_rl_rests;

/* Mean of a segment, its variance, and the prior odds of a rest. */
typedef struct {
  gd_real mean_dps, mean_var, odds;
} gd_rl_level;

/* Stages of the work in which the output belongs to the end of the block already. */
enum { GD_RL_IDLE, GD_RL_FINISH };

/* Work of a block that has ended; see restlevel_work.h. */
typedef struct {
  gd_real expected_deg;            /* yaw at its end by the estimates at its beginning, without `base_deg` */
  gd_real temp_c;                  /* at its end */
  gd_real step_dps;                /* of the block means */
  gd_real excess_var, rest_weight; /* sums over hypotheses of rest */
  gd_rl_level level;               /* of the segment that branches the hypotheses */
  gd_rl_rests rests;
  uint8_t stage, index; /* next portion */
  uint8_t later;        /* next hypothesis that may merge with the one of `index` */
  uint8_t after;        /* stage after a merge */
  uint8_t is_stationary : 1, is_certain : 1;
  uint8_t is_divided : 1; /* the user has asked for a portion since the last block ended */
#if GD_RESTLEVEL_AUXILIARY
  gd_real best; /* largest log-likelihood of a certain rest */
  gd_rl_still still;
#endif
} gd_rl_work;

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
  uint32_t suspect_us; /* see gd_step_of_us */
#if GD_RESTLEVEL_GAPS
  double longest_step_s; /* longest step that is no gap; see gaps.h */
#endif
#if GD_RESTLEVEL_AIDS
  gd_aid aid; /* waits for the end of the block */
#endif
  gd_rl_block block;
#if GD_RESTLEVEL_WORK
  gd_rl_block sums;
  gd_rl_work work;
#endif
  gd_real rate_dps;
  gd_real resolution_dps; /* smallest step between two samples so far */
  gd_real base_deg; /* with floats, yaw is kept near 0; this is the angle subtracted so far */
  gd_real start_yaw_deg, travelled_deg, travelled_s; /* since the first sample or the last zero */
  gd_rl_coefficients c;
#if GD_RESTLEVEL_MEMORY
  gd_rl_remembered remembered;
#endif
  gd_rl_noise noise;
#if GD_RESTLEVEL_VIBRATION
  gd_rl_vibration vibration;
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
  gd_bias_line line;
  gd_rl_witness witness;
#endif
  gd_rl_hypothesis hypotheses[GD_RL_STORED]; /* `stored` of them, in the order of their slots */
  uint8_t stored;
  uint8_t blocks; /* complete blocks, up to 255 */
} gd_restlevel;

#endif
