/* Attitude filter: rotations. A quaternion (w, x, y, z) turns vectors of the sensor to the earth frame, z up. */
#ifndef GD_ATTITUDE_QUATERNION_H
#define GD_ATTITUDE_QUATERNION_H

#include "attitude_matrix.h"

/* Cosine of 150 deg, the tilt from which the twist turns fast for small rotations, and w^2 + z^2 there. */
#define GD_ATTITUDE_INVERTED_UP GD_R(-0.8660254037844387)
#define GD_ATTITUDE_INVERTED GD_R(0.06698729810778066)
/* Squared angle, rad^2, up to which the series of gd_from_small_vector is exact to 1e-8. */
#define GD_ATTITUDE_SERIES_LIMIT GD_R(0.0625)
#define GD_ATTITUDE_TINY GD_R(1e-12)

static inline void gd_identity(gd_real q[4]) {
  q[0] = 1;
  q[1] = q[2] = q[3] = 0;
}

/* out = p q: the rotation q, then p. `out` may be one of them. */
static inline void gd_product(gd_real out[4], const gd_real p[4], const gd_real q[4]) {
  const gd_real w = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
  const gd_real x = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
  const gd_real y = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
  const gd_real z = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
  out[0] = w;
  out[1] = x;
  out[2] = y;
  out[3] = z;
}

static inline void gd_make_unit(gd_real q[4]) {
  const gd_real norm = GD_SQRT(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  int i;
  for (i = 0; i < 4; i++) {
    q[i] /= norm;
  }
}

/* Quaternion of a rotation vector in rad, by a series for small angles; its norm is 1 to 1e-8. */
static inline void gd_from_small_vector(gd_real q[4], gd_real x, gd_real y, gd_real z) {
  const gd_real n = x * x + y * y + z * z;
  gd_real k, angle;
  if (n < GD_ATTITUDE_SERIES_LIMIT) {
    k = GD_R(0.5) - n * (GD_R(1.0 / 48.0) - n / GD_R(3840.0));
    q[0] = GD_R(1.0) - n * (GD_R(0.125) - n / GD_R(384.0));
  } else {
    angle = GD_SQRT(n);
    k = GD_SIN(GD_R(0.5) * angle) / angle;
    q[0] = GD_COS(GD_R(0.5) * angle);
  }
  q[1] = k * x;
  q[2] = k * y;
  q[3] = k * z;
}

/* Quaternion of a rotation vector in rad. */
static inline void gd_from_vector(gd_real q[4], const gd_real v[3]) {
  const gd_real angle = GD_SQRT(gd_dot(v, v));
  const gd_real share =
      angle > GD_ATTITUDE_TINY ? GD_SIN(GD_R(0.5) * angle) / gd_max(angle, GD_ATTITUDE_TINY) : GD_R(0.5);
  q[0] = GD_COS(GD_R(0.5) * angle);
  q[1] = share * v[0];
  q[2] = share * v[1];
  q[3] = share * v[2];
}

/* Rotation vector of at most pi rad. */
static inline void gd_to_vector(gd_real v[3], const gd_real q[4]) {
  const gd_real sign = q[0] < 0 ? GD_R(-1.0) : GD_R(1.0);
  const gd_real norm = GD_SQRT(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const gd_real share =
      norm > GD_ATTITUDE_TINY ? GD_R(2.0) * GD_ATAN2(norm, sign * q[0]) / norm : GD_R(2.0);
  v[0] = share * sign * q[1];
  v[1] = share * sign * q[2];
  v[2] = share * sign * q[3];
}

/* Rotation vector from attitude a to b, in the earth frame. */
static inline void gd_vector_between(gd_real v[3], const gd_real a[4], const gd_real b[4]) {
  gd_real inverse[4], turn[4];
  inverse[0] = a[0];
  inverse[1] = -a[1];
  inverse[2] = -a[2];
  inverse[3] = -a[3];
  gd_product(turn, b, inverse);
  gd_to_vector(v, turn);
}

/* q = rotation by v in the earth frame, after q. */
static inline void gd_turn_by(gd_real q[4], const gd_real v[3]) {
  gd_real turn[4];
  gd_from_vector(turn, v);
  gd_product(q, turn, q);
  gd_make_unit(q);
}

/* Matrix (3, 3) of a quaternion. */
static inline void gd_rotation_matrix(gd_real m[9], const gd_real q[4]) {
  const gd_real w = q[0], x = q[1], y = q[2], z = q[3];
  m[0] = GD_R(1.0) - GD_R(2.0) * (y * y + z * z);
  m[1] = GD_R(2.0) * (x * y - w * z);
  m[2] = GD_R(2.0) * (x * z + w * y);
  m[3] = GD_R(2.0) * (x * y + w * z);
  m[4] = GD_R(1.0) - GD_R(2.0) * (x * x + z * z);
  m[5] = GD_R(2.0) * (y * z - w * x);
  m[6] = GD_R(2.0) * (x * z - w * y);
  m[7] = GD_R(2.0) * (y * z + w * x);
  m[8] = GD_R(1.0) - GD_R(2.0) * (x * x + y * y);
}

/* Vector v of the sensor in the earth frame; `out` may be v. */
static inline void gd_rotate(gd_real out[3], const gd_real q[4], const gd_real v[3]) {
  gd_real t[3], u[3];
  const gd_real *axis = &q[1];
  gd_cross(t, axis, v);
  t[0] *= 2;
  t[1] *= 2;
  t[2] *= 2;
  gd_cross(u, axis, t);
  out[0] = v[0] + q[0] * t[0] + u[0];
  out[1] = v[1] + q[0] * t[1] + u[1];
  out[2] = v[2] + q[0] * t[2] + u[2];
}

/* Unit vector of the earth's vertical in the sensor frame. */
static inline void gd_up_in_sensor(gd_real up[3], const gd_real q[4]) {
  up[0] = GD_R(2.0) * (q[1] * q[3] - q[0] * q[2]);
  up[1] = GD_R(2.0) * (q[2] * q[3] + q[0] * q[1]);
  up[2] = GD_R(1.0) - GD_R(2.0) * (q[1] * q[1] + q[2] * q[2]);
}

/* Vector of the sensor frame whose product with the rates is the rate of the twist about the vertical u:
   (z + u)/(1 + z u) with the z axis of the sensor, and u itself above 150 deg of tilt. */
static inline void gd_heading_axis(gd_real axis[3], const gd_real q[4]) {
  gd_up_in_sensor(axis, q);
  if (axis[2] >= GD_ATTITUDE_INVERTED_UP) {
    const gd_real k = GD_R(1.0) / (GD_R(1.0) + axis[2]);
    axis[0] *= k;
    axis[1] *= k;
    axis[2] = 1;
  }
}

/* Angle between the sensor's z axis and the vertical, 0 to 180 deg. The arc cosine of a float next to 1 is wrong by
   0.02 deg. */
static inline gd_real gd_tilt_deg(const gd_real q[4]) {
  const gd_real upright = q[0] * q[0] + q[3] * q[3], tilted = q[1] * q[1] + q[2] * q[2];
  if (GD_IS_FLOAT) {
    return GD_R(2.0) * GD_ATAN2(GD_SQRT(tilted), GD_SQRT(upright)) / GD_ATTITUDE_RAD;
  }
  return GD_ACOS(gd_max(GD_R(-1.0), gd_min(GD_R(1.0), upright - tilted))) / GD_ATTITUDE_RAD;
}

/* Roll, -180 to 180 deg: positive with the right side down. */
static inline gd_real gd_roll_deg(const gd_real q[4]) {
  gd_real up[3];
  gd_up_in_sensor(up, q);
  return GD_ATAN2(up[1], up[2]) / GD_ATTITUDE_RAD;
}

/* Pitch, -90 to 90 deg: positive with the nose down. */
static inline gd_real gd_pitch_deg(const gd_real q[4]) {
  gd_real up[3];
  gd_up_in_sensor(up, q);
  return GD_ATAN2(-up[0], GD_SQRT(up[1] * up[1] + up[2] * up[2])) / GD_ATTITUDE_RAD;
}

/* Attitude of heading 0 whose vertical has this direction in the sensor; identity for a zero vector. */
static inline void gd_level(gd_real q[4], const gd_real v[3]) {
  const gd_real norm = GD_SQRT(gd_dot(v, v));
  gd_real s;
  gd_identity(q);
  if (!(norm > 0)) {
    return;
  }
  if (v[2] < GD_R(-0.999999) * norm) {
    q[0] = 0;
    q[1] = 1;
    return;
  }
  s = GD_SQRT(GD_R(2.0) * (GD_R(1.0) + v[2] / norm));
  q[0] = GD_R(0.5) * s;
  q[1] = v[1] / (norm * s);
  q[2] = -v[0] / (norm * s);
  gd_make_unit(q);
}

/* Heading of q that is next to the expected one; the expected one itself above 150 deg of tilt. */
static inline gd_real gd_unwrapped_deg(gd_real expected_deg, const gd_real q[4]) {
  gd_real twist;
  if (q[0] * q[0] + q[3] * q[3] < GD_ATTITUDE_INVERTED) {
    return expected_deg;
  }
  twist = GD_R(2.0) * (GD_ATAN2(q[3], q[0]) / GD_ATTITUDE_RAD);
  return twist + GD_R(360.0) * GD_FLOOR((expected_deg - twist) / GD_R(360.0) + GD_R(0.5));
}

#endif
