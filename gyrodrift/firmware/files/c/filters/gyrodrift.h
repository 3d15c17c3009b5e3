/* gyrodrift.h: yaw without drift from a cheap gyro, on the microcontroller.

   C11 and C++11, one header, no allocation, no globals. Float is the default; for double:

       #define GD_REAL double
       #include "gyrodrift.h"

   A filter is one struct. `init` takes parameters, or NULL for the defaults. `update` takes a sample.
   It returns 0 if it refuses the sample: time stands still, or a value is not finite. Rates are in
   deg/s, counter-clockwise positive.

       gd_hdr h;                                    the smallest filter
       gd_hdr_init(&h, NULL);
       gd_hdr_update_us(&h, micros(), rate_dps);    or gd_hdr_update(&h, t_s, rate_dps)
       use(h.yaw_deg, h.bias_dps);

       gd_restlevel r;                              learns at each rest, and says how sure it is
       gd_restlevel_init(&r, NULL);
       gd_restlevel_update_us(&r, micros(), rate_dps);
       use(r.yaw_deg, r.yaw_sigma_deg, r.bias_dps);

       gd_attitude a;                               three axes and an accelerometer: 15 KB of RAM
       gd_attitude_init(&a, NULL);
       gd_attitude_update_us(&a, micros(), gyro_dps, accel_mps2);
       use(a.yaw_deg, a.yaw_sigma_deg, a.tilt_deg, a.q);

   The functions with `_us` take a 32-bit clock of microseconds that wraps. Boards need them where a double has 32 bits
   (AVR). A copy of the struct saves the filter. gd_restlevel_work and gd_attitude_work divide the work of an update.

   Do not compile with -ffast-math: NaN would pass as a sample.
*/
#ifndef GYRODRIFT_H
#define GYRODRIFT_H

#include "hdr.h"
#include "restlevel.h"
#include "restlevel_with.h"
#include "restlevel_zero.h"
#include "restlevel_memory.h"
#include "attitude.h"
#include "attitude_zero.h"
#include "calibration.h"
#include "wrappers.h"

#endif
