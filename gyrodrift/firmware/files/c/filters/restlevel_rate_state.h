/* State of restlevel that describes the rate: block, noise, levels and segments. Twin of restlevel/rate_state.py. */
#ifndef GD_RESTLEVEL_RATE_STATE_H
#define GD_RESTLEVEL_RATE_STATE_H

#include "real.h"

#define GD_NEVER 255 /* largest number of blocks since an event; the count stays there */
#define GD_TURN_SLOTS 32

/* Sums over the samples of the present block, of rates minus its first rate. */
typedef struct {
  double seconds;
  gd_real angle_deg;
  gd_real origin_dps, sum_dps, sum_squares;
  uint32_t samples;
  uint32_t repeats; /* samples that repeat the value before of a fine sensor */
} gd_rl_block;

/* Noise of the sensor. Variances and the resolution are -1 until they are known. */
typedef struct {
  gd_real sample_var;     /* of the samples of stationary blocks, (deg/s)^2 */
  gd_real last_block_var; /* of the samples of the block before */
  gd_real resolution_dps; /* smallest step between two samples, up to the end of the block */
  gd_real angle_walk_var; /* N^2 of the angle random walk (IEEE Std 952), deg^2/s */
  gd_real flicker_var;    /* bias instability, (deg/s)^2 */
  gd_real frozen_deg;     /* angle since the sensor repeats a single value */
  uint8_t stationary_blocks; /* up to GD_NOISE_BLOCKS */
  int8_t same_blocks;        /* 1 after a block of a single value at power-on; below 0 after the first step */
  uint8_t has_steps : 1, is_walk_measured : 1, has_dropped : 1, is_frozen : 1;
} gd_rl_noise;

/* Noise of blocks that are louder than the sensor. */
typedef struct {
  gd_real sample_var; /* mean variance of samples of consecutive blocks that are equally loud */
  gd_real mean_var;   /* of block means of the present loud segment */
  gd_real motions, motion_var; /* loud segments that were motions, and their mean variance of samples */
  uint8_t blocks;     /* consecutive blocks that are equally loud, up to GD_NOISE_BLOCKS */
} gd_rl_loud;

/* Agreement of consecutive stationary blocks outside of confirmed segments. */
typedef struct {
  gd_real log_odds; /* of wandering levels against the noise of a sensor */
  gd_real step_dps; /* median step between levels */
  uint8_t steps;
  uint8_t was_stationary;
} gd_rl_wander;

/* Present constant-rate segment: a run of stationary blocks with the same mean. */
typedef struct {
  double seconds;
  gd_real mean_dps;
  gd_real sum_squares; /* of the steps between its block means */
  gd_real sensor_odds;
  gd_real head_sum_dps; /* of its first two block means */
  gd_real last_mean_dps;
  gd_real least_dps, most_dps; /* range of all block means but the first */
  uint32_t blocks;             /* 0 without a segment */
  uint8_t is_loud, averages_out; /* louder than the sensor; block means scatter less than white noise */
} gd_rl_segment;

/* The last constant-rate segment that has ended. */
typedef struct {
  double seconds;
  gd_real mean_dps, sensor_odds;
  gd_real sample_var; /* of a loud segment */
  uint8_t is_loud;
  uint8_t ended_gradually;
  uint8_t blocks_ago;
  uint8_t short_start_blocks; /* its blocks, if the present block has ended a short rest from the start */
} gd_rl_ended;

/* Mean rates of some seconds of motion or of a segment, the latest ones in a ring, and their median. */
typedef struct {
  double seconds; /* of the present one */
  gd_real angle_deg;
  gd_real median_dps, median_var;
  gd_real latest_dps[GD_TURN_SLOTS];
  uint8_t ordered[GD_TURN_SLOTS]; /* indices of the latest, from the least to the largest */
  uint8_t count;                 /* from 32 on it counts around, up to 63 */
} gd_rl_turns;

#endif
