/* A filter of gyrodrift.h on a board without anything else, for simavr (avr_cycles.c) and for QEMU (board_arm.h).

   FILTER_RESTLEVEL chooses restlevel, FILTER_ATTITUDE the filter of three axes, else it is HDR. The board reads samples,
   u32 t_us and float rate_dps, or three rates and three accelerations, and sends float yaw_deg and bias_dps after each.
   board_mark tells where an update begins (1) and ends (2). PORTIONS is the number of portions of work after each
   update; the board sends the same after each of them.
*/
#include "gyrodrift.h"

#ifdef FILTER_ATTITUDE
#define FILTER gd_attitude
#define NUMBERS 6
#define INIT gd_attitude_init
#define UPDATE(filter, t_us, sample) gd_attitude_update_us(filter, t_us, sample, sample + 3)
#define WORK gd_attitude_work
#elif defined FILTER_RESTLEVEL
#define FILTER gd_restlevel
#define NUMBERS 1
#define INIT gd_restlevel_init
#define UPDATE(filter, t_us, sample) gd_restlevel_update_us(filter, t_us, sample[0])
#define WORK gd_restlevel_work
#else
#define FILTER gd_hdr
#define NUMBERS 1
#define INIT gd_hdr_init
#define UPDATE(filter, t_us, sample) gd_hdr_update_us(filter, t_us, sample[0])
#endif

#ifndef PORTIONS
#define PORTIONS 0
#endif

#ifdef __AVR__
#include "board_avr.h"
#else
#include "board_arm.h"
#endif

static FILTER filter;

static void tell(void) {
  board_mark(2);
  board_write(&filter.yaw_deg, sizeof filter.yaw_deg);
  board_write(&filter.bias_dps, sizeof filter.bias_dps);
}

int main(void) {
  board_begin();
  INIT(&filter, NULL);
  for (;;) {
    uint32_t t_us;
    float sample[NUMBERS];
    board_read(&t_us, sizeof t_us);
    board_read(sample, sizeof sample);
    board_mark(1);
    UPDATE(&filter, t_us, sample);
    tell();
#if PORTIONS
    for (int i = 0; i < PORTIONS; i++) {
      board_mark(1);
      WORK(&filter);
      tell();
    }
#endif
  }
}
