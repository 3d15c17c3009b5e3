/* Runs board_filter.c on an AVR in simavr, and prints what each update costs.

   avr_cycles FIRMWARE.elf SAMPLES HEAP CHIP

   SAMPLES is a file of u32 t_us and float rate_dps. HEAP is the address of _end, where free RAM begins. For each
   sample there is a line: cycles, yaw_deg, bias_dps. The last line is the number of bytes of RAM that stayed free.
*/
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GPIOR0 0x3e /* addresses of ATmega328P and ATmega1284P */
#define GPIOR1 0x4a
#define GPIOR2 0x4b
#define PAINT 0xc5
#define REPLY 8 /* bytes after a sample */

typedef struct {
  avr_t *avr;
  FILE *samples;
  avr_cycle_count_t began;
  unsigned long cycles;
  uint8_t reply[REPLY];
  unsigned replied;
  int is_over;
} bench;

static uint8_t give_byte(avr_t *avr, avr_io_addr_t address, void *param) {
  bench *b = param;
  const int byte = fgetc(b->samples);
  (void)avr, (void)address;
  b->is_over = byte == EOF;
  return (uint8_t)byte;
}

static void take_mark(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  bench *b = param;
  (void)address;
  if (value == 1) {
    b->began = avr->cycle;
  } else {
    b->cycles = (unsigned long)(avr->cycle - b->began);
  }
}

static void take_byte(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  bench *b = param;
  float said[2];
  (void)avr, (void)address;
  b->reply[b->replied++] = value;
  if (b->replied == REPLY) {
    memcpy(said, b->reply, sizeof said);
    printf("%lu,%.9g,%.9g\n", b->cycles, (double)said[0], (double)said[1]);
    b->replied = 0;
  }
}

static void no_log(avr_t *avr, const int level, const char *format, va_list rest) {
  (void)avr, (void)level, (void)format, (void)rest;
}

static unsigned free_bytes(const avr_t *avr, unsigned heap) {
  unsigned at = heap;
  while (at <= avr->ramend && avr->data[at] == PAINT) {
    at++;
  }
  return at - heap;
}

int main(int argc, char **argv) {
  static elf_firmware_t firmware;
  static bench b;
  unsigned heap;
  avr_global_logger_set(no_log);
  if (argc != 5 || elf_read_firmware(argv[1], &firmware) || !(b.samples = fopen(argv[2], "rb"))) {
    fprintf(stderr, "avr_cycles FIRMWARE.elf SAMPLES HEAP CHIP\n");
    return 2;
  }
  heap = (unsigned)strtoul(argv[3], NULL, 16) & 0xffff;
  b.avr = avr_make_mcu_by_name(argv[4]);
  avr_init(b.avr);
  b.avr->frequency = 16000000;
  avr_load_firmware(b.avr, &firmware);
  memset(b.avr->data + heap, PAINT, b.avr->ramend + 1 - heap);
  avr_register_io_read(b.avr, GPIOR1, give_byte, &b);
  avr_register_io_write(b.avr, GPIOR0, take_mark, &b);
  avr_register_io_write(b.avr, GPIOR2, take_byte, &b);
  while (!b.is_over) {
    const int state = avr_run(b.avr);
    if (state == cpu_Done || state == cpu_Crashed) {
      fprintf(stderr, "the board has crashed\n");
      return 1;
    }
  }
  printf("%u\n", free_bytes(b.avr, heap));
  return 0;
}
