/* Attitude filter: the state, with the work at the end of a block and samples that wait for it. */
#ifndef GD_ATTITUDE_STATE_H
#define GD_ATTITUDE_STATE_H

#include "attitude_model.h"

/* The part of the transition matrix that is no identity.

   `turn` has the derivatives (3, 12) of the attitude by bias and scale. The heading stays where the hypothesis stands
   still (`is_held`). `fall` is the vertical integral of the specific force: it couples attitude and velocity. The
   horizontal part does not: through a bounded velocity, accelerations of a vehicle would show a heading. */
typedef struct {
  gd_real turn[3][12], fall;
  int is_held;
} gd_attitude_transition;

/* An accepted sample: time and step from the one before, s; rates, accelerations, and the report of a rest sensor,
   and temperature. */
typedef struct {
  double t_s, dt_s;
  gd_real gyro[3], accel[3], still, temp_c;
} gd_attitude_sample;

/* Work at the end of a block or at a gap; see attitude_job.h. */
typedef struct {
  uint8_t stage, index, later, after; /* next portion; stage after a merge */
  uint8_t is_blind;                   /* the block has no acceleration */
  uint8_t is_certain, is_found, is_continued; /* kind of its rest candidate */
  uint8_t is_repeated, was_brief;          /* its rests are measured again; they were brief ones */
  uint8_t is_at_gap;                       /* a gap begins after the block */
  uint8_t is_divided, waits;               /* the user has asked for a portion since the last block ended, and before */
  uint8_t rests;                           /* hypotheses of rest, which are first in the list */
  int32_t turns_before;                    /* whole turns, and heading without them, before a correction */
  gd_real before_deg;
  gd_real heading_deg;                     /* heading at the last sample that was summed up */
  uint8_t is_guess;                        /* the output goes on by the last estimates */
  gd_attitude_integrals block;             /* a copy of the state moves the derivatives: take those of its block */
  gd_real usable_velocity[3];              /* integral of the specific force; without acceleration that of gravity */
  gd_real velocity_var, share, factor;     /* of the bounded velocity */
  gd_attitude_candidate candidate;
  gd_attitude_transition transition;
  gd_real error[GD_ATTITUDE_STATES];       /* of a hypothesis of rest between its two measurements */
  gd_real odds, overlap;                   /* prior odds of a rest that begins; see gd_attitude_rest_variances */
  gd_real log_rest[GD_ATTITUDE_SLOTS], log_motion[GD_ATTITUDE_SLOTS];
  gd_real still, temp_c;                   /* of the sample after a gap */
  uint8_t oldest, queued;                  /* samples that wait, in a ring */
  gd_attitude_sample queue[GD_ATTITUDE_QUEUE];
} gd_attitude_job;

/* The filter. Results first; memcpy of the whole saves and restores it. */
typedef struct {
  gd_real yaw_deg, yaw_sigma_deg;   /* unwrapped heading, 0 at the first sample, and its standard deviation */
  gd_real bias_dps, bias_sigma_dps; /* bias of the rate of the heading */
  gd_real bias_xyz_dps[3], bias_sigma_xyz_dps[3]; /* bias of the three axes */
  gd_real q[4];                     /* attitude (w, x, y, z), sensor to earth, z up */
  gd_real tilt_deg, tilt_sigma_deg; /* angle between the sensor's z axis and the vertical */
  gd_real heading_rate_dps;         /* rate of the heading by the measured rates */
  gd_real rest_probability, confidence;
  uint32_t samples, rejected; /* accepted and refused samples */
  gd_real correction_deg;     /* step of yaw in the last sample that is no motion: a change of the estimate */
  uint16_t corrections;       /* number of those over 1 deg */
  double longest_step_s;      /* longest step that is no gap; see gaps.h */
  uint8_t has_restarted;      /* the bias was reopened after a gap */
  int32_t turns;             /* whole turns in yaw_deg */
  gd_real heading_deg;       /* yaw_deg without them: exact in float after thousands of turns */
  gd_aid aid;                /* waits for the end of the block */
  double t_s;                /* time of the last accepted sample */
  double accel_t_s;          /* time of the last acceleration that was not NaN */
  uint32_t t_us, suspect_us; /* clock of the board at the last accepted sample; see gd_step_of_us */
  gd_real gyro_dps[3], suspect_dps[3], suspect_s; /* last rates, and those of a sample that may be a spike */
  gd_real accel_mps2[3];
  gd_real start_q[4], start_deg; /* output attitude and heading at the beginning of the block */
  gd_real temp_c;                /* GD_UNKNOWN_C until there is one */
  double lived_s, sure_s;        /* since the first sample, and length of the present sure rest */
  gd_bias_line line[3];          /* bias of the axes against temperature */
  gd_attitude_remembered remembered;
  uint8_t remembers;             /* hypotheses have a remembered bias, and there was no rest candidate yet */
  gd_real noise_var;             /* angle random walk of the gyro, rad^2/s */
  gd_real turn_on_bias[3];       /* mean of the prior of an unknown bias, rad/s: 0, or the bias before a restart */
  gd_attitude_coefficients c;
  gd_attitude_block block;
  gd_attitude_windows windows;
  gd_attitude_segment segment;
  gd_attitude_witness witness;
  gd_attitude_motion motion;
  gd_attitude_sum sum;
  gd_attitude_job job;
} gd_attitude;

/* Hypothesis number i of the sum. */
static inline gd_attitude_hypothesis *gd_attitude_at(gd_attitude *a, int i) { return &a->sum.slot[a->sum.order[i]]; }

#endif
