/* Input and output of board_filter.c on an ATmega328P: three registers that avr_cycles.c watches. */
#include <avr/io.h>

static void board_begin(void) {}

static void board_mark(uint8_t mark) { GPIOR0 = mark; }

static void board_read(void *to, uint8_t bytes) {
  uint8_t *next = (uint8_t *)to;
  while (bytes-- > 0) {
    *next++ = GPIOR1;
  }
}

static void board_write(const void *from, uint8_t bytes) {
  const uint8_t *next = (const uint8_t *)from;
  while (bytes-- > 0) {
    GPIOR2 = *next++;
  }
}
