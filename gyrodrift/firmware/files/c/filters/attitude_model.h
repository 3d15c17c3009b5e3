/* Attitude filter: coefficients and state of the attitude filter. Units inside: rad, s, m. */
#ifndef GD_ATTITUDE_MODEL_H
#define GD_ATTITUDE_MODEL_H

#include "aid.h"
#include "beliefs.h"
#include "bias_line.h"
#include "contradictions.h"
#include "gaps.h"
#include "parameters.h"
#include "real.h"
#include "restlevel_bias_state.h"

/* Hypotheses that are kept: 6 as in Python. Fewer save RAM (about 2 KB each in float, as each may branch into two) and
   lose the less probable of several explanations of a start without a clear rest. */
#ifndef GD_ATTITUDE_HYPOTHESES
#define GD_ATTITUDE_HYPOTHESES 6
#endif
#if GD_ATTITUDE_HYPOTHESES < 2
#error "GD_ATTITUDE_HYPOTHESES: expected 2 or more"
#endif
#define GD_ATTITUDE_SLOTS (2 * GD_ATTITUDE_HYPOTHESES)

/* Samples that wait while gd_attitude_work works on a block: 0.16 s at 100 Hz. If more come, an update does what is
   left of the work. */
#ifndef GD_ATTITUDE_QUEUE
#define GD_ATTITUDE_QUEUE 16
#endif
#if GD_ATTITUDE_QUEUE < 1 || GD_ATTITUDE_QUEUE > 255
#error "GD_ATTITUDE_QUEUE: expected 1 to 255"
#endif

#define GD_ATTITUDE_RAD GD_R(0.017453292519943295)
#define GD_ATTITUDE_BLOCKS_PER_WINDOW 3.0
#define GD_ATTITUDE_SPREAD_OF_BIAS GD_R(1.4)
#define GD_ATTITUDE_BIAS_WALK GD_R(3.0)
#define GD_ATTITUDE_CROSS_AXIS GD_R(0.2)
#define GD_ATTITUDE_DEFAULT_QUIET GD_R(5.0)
#define GD_ATTITUDE_GRAVITY GD_R(9.81)
/* Rates above this are no measurement, deg/s. */
#define GD_ATTITUDE_FASTEST_DPS GD_R(10000.0)
/* Largest standard deviation of a bias of which a float keeps a rest's accuracy beside it, rad/s. Raw parts of data
   sheets have 20 deg/s. */
#define GD_ATTITUDE_LARGEST_FLOAT_BIAS (GD_R(30.0) * GD_ATTITUDE_RAD)

/* Error states: rotation in the earth frame, rad; bias, rad/s; velocity in the earth frame, m/s; scale and misalignment
   of the gyro, row by row; bias of the accelerometer, m/s^2. */
enum {
  GD_ATTITUDE_ATTITUDE = 0,
  GD_ATTITUDE_HEADING = 2,
  GD_ATTITUDE_BIAS = 3,
  GD_ATTITUDE_VELOCITY = 6,
  GD_ATTITUDE_SCALE = 9,
  GD_ATTITUDE_FORCE_BIAS = 18,
  GD_ATTITUDE_STATES = 21
};

/* Regimes of a hypothesis in the present segment. */
enum { GD_ATTITUDE_UNDECIDED = 0, GD_ATTITUDE_REST = 1, GD_ATTITUDE_TURN = 2 };

/* Blocks that are kept for the search of rests. */
enum { GD_ATTITUDE_LONGEST = 40 };

/* Values that follow from the parameters of restlevel. */
typedef struct {
  double block_s;                   /* length of a block, s */
  gd_real bias_sigma;               /* standard deviation of the bias at power-on, rad/s */
  gd_real walk_var;                 /* its random walk, (rad/s)^2/s */
  gd_real drift_rate;               /* its fastest drift, rad/s^2 */
  gd_real scale_sigma, cross_sigma; /* standard deviations of scale factor and misalignment, as shares */
  gd_real start_odds, rest_odds;    /* prior odds of a rest against an even turn at the start, and later */
  gd_real limits;                   /* factor on the spread of block means in a rest */
} gd_attitude_coefficients;

/* A Gaussian over attitude, bias, velocity, scale and misalignment for a sequence of regimes. */
typedef struct {
  gd_real weight; /* probability */
  gd_real q[4], bias[3], velocity[3], scale[9], force_bias[3];
  gd_real yaw_deg;                                                /* heading, next to 0: whole turns are in the state */
  gd_real cov[GD_ATTITUDE_STATES * (GD_ATTITUDE_STATES + 1) / 2]; /* upper triangle of the covariance, row by row */
  gd_real moving_s; /* time since the last measured rest */
  uint8_t regime;
  uint8_t knows_bias; /* a rest of 1 s or more was measured */
} gd_attitude_hypothesis;

/* The Gaussian sum: `order` lists the slots in use, the most probable one first after each block. */
typedef struct {
  gd_attitude_hypothesis slot[GD_ATTITUDE_SLOTS];
  uint8_t order[GD_ATTITUDE_SLOTS];
  uint8_t count;
} gd_attitude_sum;

/* Samples between two updates, integrated once for all hypotheses. Rotations are corrected by the bias and scale of the
   most probable one. Sums over steps of 8 ms stand for the list of steps in Python. */
typedef struct {
  gd_real gain[9], offset[3]; /* (I + scale) pi/180, and that matrix times the bias, rad/s */
  gd_real q[4], step_q[4];    /* rotation since the beginning of the block: now, and at the end of the last step */
  double seconds, step_s;
  gd_real angle[3], velocity[3];         /* sums since the last step: deg, m/s */
  gd_real all_angle[3], all_velocity[3]; /* sums of all finished steps, in the turning sensor */
  gd_real force[3];                      /* integral of the specific force in the frame of the beginning, m/s */
  gd_real by_bias[9], by_scale[27];      /* derivatives of the rotation: minus that by the bias, and that by scale */
  gd_real squared_turn;                  /* integral of the squared rate, rad^2/s */
  uint32_t samples, still, moving;
  uint8_t is_clipped; /* an acceleration was at the end of its range */
  uint8_t has_steps;
} gd_attitude_block;

/* A finished block, in the frame of the sensor at its beginning. */
typedef struct {
  gd_real seconds;
  gd_real rotation[4];
  gd_real velocity[3];        /* integral of the specific force, m/s; NaN without acceleration */
  gd_real gyro[3], accel[3];  /* means of rates, rad/s, and accelerations, m/s^2, in the turning sensor */
  const gd_real *by_bias;     /* (3, 3), of the block */
  const gd_real *by_scale;    /* (3, 9) */
  gd_real squared_turn;
} gd_attitude_integrals;

/* Means of the last blocks in units of their limits: rates (3) and accelerations (3). */
typedef struct {
  gd_real rows[GD_ATTITUDE_LONGEST][6];
  uint8_t slot;    /* row of the next block */
  uint8_t is_blind; /* the blocks have no acceleration */
  int32_t blocks;  /* blocks in the windows */
  int32_t total;   /* blocks since the first sample */
} gd_attitude_windows;

/* Length of a window in blocks, factors on the limits of a quiet rest, and on the error of the bias it shows. */
typedef struct {
  int32_t blocks;
  gd_real gyro, accel, bias;
} gd_attitude_kind;

/* A window that looks still. */
typedef struct {
  gd_attitude_kind kind;
  gd_real gyro[3], gyro_var[3]; /* mean rates, rad/s, and variances of block means */
  gd_real accel[3];             /* mean acceleration, m/s^2; zero without an accelerometer */
} gd_attitude_candidate;

/* Present or last rest candidate. */
typedef struct {
  int32_t blocks;  /* length of the window that was found last; 0 without a candidate */
  int32_t since;   /* blocks since the last update */
  int32_t ago;     /* blocks since its end */
  gd_real seconds; /* time since the candidate was found */
  gd_real gyro[3]; /* mean rates where it was found, rad/s */
  gd_real up[3];   /* vertical in the sensor where it was found */
  gd_real level;   /* mean rate about the vertical before the newest blocks, rad/s */
  gd_real undone;  /* change of the biases about the vertical at a gradual end, rad/s */
  gd_rl_hypothesis rest; /* most probable rest, about the vertical: its bias, deg/s, and the slide of that bias */
  int32_t level_blocks;  /* blocks in a row that have its rate */
  uint8_t ended_gradually; /* the rate left it slowly */
} gd_attitude_segment;

/* External rest sensor. */
typedef struct {
  uint8_t is_believed;
  uint32_t refuted; /* contradictions */
  uint32_t blocks;  /* blocks in a row that it calls still */
  gd_real contradictions; /* blocks that contradict, less a tenth for each that fits */
} gd_attitude_witness;

/* Averages over the last seconds: how far accelerations and tilts can be trusted. */
typedef struct {
  double level_s;
  gd_real level_force[3];              /* time with an acceleration, up to the end of levelling, and its force, m/s */
  gd_real mean_force[3];               /* mean specific force in the earth frame, m/s^2 */
  gd_real slow_velocity[3], speed_var; /* slow part of the velocity, m/s, and its mean square */
  gd_real mean_up[3];                  /* mean vertical in the sensor */
  gd_real rest_up[3], moved_var;       /* vertical at the last rest, and largest squared distance from it since */
} gd_attitude_motion;

/* Biases of an earlier run: their probability, 0 without any, deg/s and (deg/s)^2. */
typedef struct {
  gd_real weight;
  gd_real bias_dps[3], bias_var[3];
} gd_attitude_remembered;

/* Length of a block, s. A float of 0.3 is larger than 0.3, and a block would have a sample more than in Python: so the
   window is rounded to whole microseconds. */
static inline double gd_attitude_block_s(gd_real window_s) {
  const double rounded_s = floor((double)window_s * 1e6 + 0.5) / 1e6;
  return (GD_IS_FLOAT && window_s >= GD_R(1e-3) ? rounded_s : (double)window_s) / GD_ATTITUDE_BLOCKS_PER_WINDOW;
}

/* Coefficients of the parameters of restlevel. */
static inline gd_attitude_coefficients gd_attitude_coefficients_of(const gd_restlevel_params *p) {
  gd_attitude_coefficients c;
  const gd_real scale = p->scale_percent / GD_R(100.0);
  const gd_real walk = GD_ATTITUDE_BIAS_WALK * p->walk_dps_rts * GD_ATTITUDE_RAD;
  c.block_s = gd_attitude_block_s(p->window_s);
  c.bias_sigma = GD_ATTITUDE_SPREAD_OF_BIAS * p->turn_on_dps * GD_ATTITUDE_RAD;
  c.bias_sigma = GD_IS_FLOAT ? gd_min(c.bias_sigma, GD_ATTITUDE_LARGEST_FLOAT_BIAS) : c.bias_sigma;
  c.walk_var = walk * walk;
  c.drift_rate = p->drift_dps_s * GD_ATTITUDE_RAD;
  c.scale_sigma = scale;
  c.cross_sigma = GD_ATTITUDE_CROSS_AXIS * scale;
  c.start_odds = p->still_start / (GD_R(1.0) - p->still_start);
  c.rest_odds = p->rest_share / (GD_R(1.0) - p->rest_share);
  c.limits = GD_SQRT(p->quiet / GD_ATTITUDE_DEFAULT_QUIET);
  return c;
}

#endif
