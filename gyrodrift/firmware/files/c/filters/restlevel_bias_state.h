/* State of restlevel between blocks: hypotheses and the rest sensor. Twin of restlevel/bias_state.py. */
#ifndef GD_RESTLEVEL_BIAS_STATE_H
#define GD_RESTLEVEL_BIAS_STATE_H

#include "bias_line.h"

/* Yaw of a hypothesis where the present segment began. */
typedef struct {
  gd_real yaw_deg, yaw_var, covariance, moving_s;
} gd_rl_checkpoint;

/* Bias of a rest some time ago. */
typedef struct {
  double ago_s;
  gd_real bias_dps, bias_var;
} gd_rl_mark;

/* Assumption about which segments were rests, and its Gaussian over yaw and bias.

   Python keeps hypotheses in slots, of which some are free. Here they are stored without gaps in the order of their
   slots, so that every sum runs in the same order. */
typedef struct {
  gd_rl_mark recent, safe; /* see restlevel_slide.h */
  gd_real weight;          /* probability */
  gd_real bias_dps, yaw_deg;
  gd_real bias_var, covariance, yaw_var;
  gd_real moving_s; /* since its last rest */
  gd_real rest_odds, chance_density, noisy_density, odds; /* see restlevel_durations.h */
  gd_real slide_dps;
  gd_real turn_density;                                   /* see restlevel_turns.h */
  gd_rl_checkpoint checkpoint;
  uint8_t slot : 4;
  uint8_t knows_bias : 1; /* after its first rest; before, the bias is 0 with the sigma of the turn-on bias */
  uint8_t is_at_rest : 1, was_at_rest : 1;
  uint8_t has_been_flat : 1;
} gd_rl_hypothesis;

/* All hypotheses as one Gaussian when the present block began; its bias is `bias_dps` of the filter. */
typedef struct {
  gd_real yaw_deg, bias_var, covariance, yaw_var;
} gd_rl_moments;

/* Remembered bias, as an initial hypothesis. */
typedef struct {
  gd_real weight; /* probability; 0 without such a bias */
  gd_real bias_dps, bias_var;
} gd_rl_remembered;

/* An external rest sensor, and whether it is believed. */
typedef struct {
  gd_real contradictions;  /* contradicting blocks; a block that fits removes GD_FIT_CREDIT */
  gd_real level_dps;       /* mean of the agreeing blocks */
  gd_real before_dps;      /* bias when it began to report rest */
  gd_real since_s;         /* since the last rest */
  uint16_t refuted;        /* number of refutations */
  uint8_t agreeing_blocks; /* last contradicting blocks that agree with each other */
  uint8_t is_moving : 1, is_silent : 1;   /* a sample was in motion, or not reported at rest: in the present block */
  uint8_t has_moved : 1, has_silence : 1; /* likewise in the block that has ended */
  uint8_t is_reporting_rest : 1, was_certain : 1, is_believed : 1;
} gd_rl_witness;

/* Mean and variances of the block of a certain rest. */
typedef struct {
  gd_real mean_dps, mean_var, flicker_var, ramp_var;
} gd_rl_still;

#endif
