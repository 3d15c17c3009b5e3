/* An Arduino Uno that is not there: an ATmega328P in simavr, a gyro on its I2C, its serial line on a pty.

   avr_board SKETCH.elf LINK [option=value]...

   The board boots when a reader has opened the port at LINK, as a real one does when DTR rises. A full pty stops the
   board's time, so that whatever is lost was lost by the sketch. It ends after `seconds` of its own time, when the
   reader has taken everything, and prints what the gyro measured and how it was set, one line of JSON.

   gyro=mpu6050    mpu6050, lsm6dso or icm20948
   seconds=10      of the board's time
   speed=0         times real time; 0 is as fast as it goes
   truth=FILE      t_us,rate_raw,temp_c,gyro_x,gyro_y,accel_x,accel_y,accel_z of each measurement that the pin tells of,
                   by the clock of the board
   clip=0          1: the accelerometer feels 40 g along x in the first half of each second
   ppm=3000        how much faster the gyro's clock runs than the board's
   absent=0        seconds before the gyro is plugged in
   reset=0         second at which the gyro forgets its settings; 0 never
   pin=1           whether its data-ready pin is wired
   held=0          clocks after which the gyro lets go of SDA, which it holds because the board was reset while it spoke
*/
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <simavr/avr_ioport.h>
#include <simavr/avr_twi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include "gyros.h"

#define CPU_HZ 16000000
#define PULSE_US 50
#define SETTLING_MS 50 /* the sketch deals with the last measurement */
#define READER_MS 20
#define DRAINED_MS 50
#define DRAIN_MS 5000

typedef struct {
  avr_t *avr;
  gyro chip;
  double seconds, speed, ppm, absent_s, reset_s, has_pin, held_clocks, clips;
  FILE *truth;
  int master;
  const char *slave;
  avr_irq_t *twi_in, *pin, *sda;
  uint32_t scl;
  uint8_t selected, reg;
  bool has_reg, was_reset;
  double next_cycle; /* of the gyro */
  long measured;
  uint64_t random;
  unsigned char out[4096];
  size_t out_bytes;
} board;

static void die(const char *what) {
  perror(what);
  exit(1);
}

/* The serial line. */

static bool has_reader(const board *b) {
  struct pollfd at = {b->master, 0, 0};
  return poll(&at, 1, 0) >= 0 && !(at.revents & POLLHUP);
}

static void send_out(board *b) {
  size_t sent = 0;
  while (sent < b->out_bytes && has_reader(b)) {
    const ssize_t count = write(b->master, b->out + sent, b->out_bytes - sent);
    if (count > 0) {
      sent += (size_t)count;
    } else {
      struct pollfd at = {b->master, POLLOUT, 0};
      poll(&at, 1, 100);
    }
  }
  b->out_bytes = 0;
}

static void uart_byte(avr_irq_t *irq, uint32_t value, void *param) {
  board *b = param;
  (void)irq;
  b->out[b->out_bytes++] = (unsigned char)value;
  if (b->out_bytes == sizeof b->out) {
    send_out(b);
  }
}

static void open_pty(board *b, const char *link) {
  struct termios raw;
  int slave, packets = 1;
  b->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (b->master < 0 || grantpt(b->master) || unlockpt(b->master)) {
    die("pty");
  }
  b->slave = ptsname(b->master);
  slave = open(b->slave, O_RDWR | O_NOCTTY);
  if (slave < 0 || tcgetattr(slave, &raw)) {
    die(b->slave);
  }
  cfmakeraw(&raw);
  tcsetattr(slave, TCSANOW, &raw);
  ioctl(b->master, TIOCPKT, &packets);
  close(slave);
  if (symlink(b->slave, link)) {
    die(link);
  }
}

/* pyserial ends opening a port with a flush, which a pty in packet mode reports. */
static void wait_for_reader(const board *b) {
  unsigned char heard[64];
  for (;;) {
    const ssize_t count = has_reader(b) ? read(b->master, heard, sizeof heard) : 0;
    if (count > 0 && (heard[0] & TIOCPKT_FLUSHREAD)) {
      return;
    }
    usleep(READER_MS * 1000);
  }
}

/* A reader that left leaves its bytes unread. */
static void drain(board *b) {
  int waiting = 0, quiet_ms = 0, ms = 0, slave;
  send_out(b);
  if (!has_reader(b)) {
    return;
  }
  slave = open(b->slave, O_RDWR | O_NOCTTY | O_NONBLOCK);
  while (slave >= 0 && quiet_ms < DRAINED_MS && ms++ < DRAIN_MS) {
    ioctl(slave, FIONREAD, &waiting);
    quiet_ms = waiting ? 0 : quiet_ms + 1;
    usleep(1000);
  }
  close(slave);
}

/* The gyro: its surroundings, its clock, its pin. */

static double uniform(board *b) {
  b->random = b->random * 6364136223846793005u + 1442695040888963407u;
  return (double)(b->random >> 11) / 9007199254740992.0;
}

static double normal(board *b) { return sqrt(-2.0 * log(1.0 - uniform(b))) * cos(2.0 * M_PI * uniform(b)); }

static double seconds_now(const board *b) { return (double)b->avr->cycle / CPU_HZ; }

/* At rest for 4 s of 12, then once there and back. */
static double rate_at(board *b, double t_s) {
  const double phase = fmod(t_s, 12.0);
  const double turn = phase < 4.0 ? 0.0 : 120.0 * sin((phase - 4.0) * M_PI / 4.0);
  return turn + 0.35 + 0.04 * normal(b);
}

/* The other axes swing, each in its own way; gravity stays along z. */
static void surroundings(board *b, double t_s, double *rates_dps, double *accels_g) {
  rates_dps[0] = 1.5 + 40.0 * sin(0.7 * t_s) + 0.04 * normal(b);
  rates_dps[1] = -2.5 - 25.0 * sin(1.1 * t_s) + 0.04 * normal(b);
  rates_dps[2] = rate_at(b, t_s);
  accels_g[0] = b->clips != 0.0 && fmod(t_s, 1.0) < 0.5 ? 40.0 : 0.3 * sin(0.5 * t_s) + 0.004 * normal(b);
  accels_g[1] = -0.2 * sin(0.9 * t_s) + 0.004 * normal(b);
  accels_g[2] = 1.0 + 0.1 * sin(2.0 * t_s) + 0.004 * normal(b);
}

static bool is_plugged(const board *b) { return seconds_now(b) >= b->absent_s; }

static bool is_over(const board *b) { return seconds_now(b) >= b->seconds; }

static avr_cycle_count_t pulse_ends(avr_t *avr, avr_cycle_count_t when, void *param) {
  board *b = param;
  (void)avr, (void)when;
  avr_raise_irq(b->pin, 0);
  return 0;
}

static void raise_pin(board *b) {
  if (b->has_pin == 0.0) {
    return;
  }
  avr_raise_irq(b->pin, 1);
  if (!b->chip.model->is_latched) {
    avr_cycle_timer_register_usec(b->avr, PULSE_US, pulse_ends, b);
  }
}

static void measure(board *b, double t_s) {
  const double temp_c = 24.0 + 6.0 * (1.0 - exp(-t_s / 120.0));
  double rates_dps[3], accels_g[3];
  int16_t rates[3], accels[3];
  surroundings(b, t_s, rates_dps, accels_g);
  gyro_measure(&b->chip, rates_dps, accels_g, temp_c, rates, accels);
  if (!b->chip.model->raises_pin(&b->chip)) { /* a sketch that reads registers by its own clock */
    return;
  }
  b->measured++;
  if (b->truth) {
    fprintf(b->truth, "%.3f,%d,%.4f,%d,%d,%d,%d,%d\n", t_s * 1e6, rates[2], temp_c, rates[0], rates[1], accels[0],
            accels[1], accels[2]);
  }
  raise_pin(b);
}

/* Called whenever the gyro may measure; where it is not set up yet, a millisecond later. */
static avr_cycle_count_t gyro_tick(avr_t *avr, avr_cycle_count_t when, void *param) {
  board *b = param;
  double rate_hz;
  (void)avr;
  if (b->reset_s > 0.0 && !b->was_reset && seconds_now(b) >= b->reset_s) {
    gyro_reset(&b->chip);
    b->was_reset = true;
  }
  rate_hz = is_plugged(b) && !is_over(b) ? b->chip.model->rate_hz(&b->chip) : 0.0;
  if (rate_hz > 0.0) {
    measure(b, seconds_now(b));
    b->next_cycle += CPU_HZ / (rate_hz * (1.0 + b->ppm * 1e-6));
  } else {
    b->next_cycle = (double)when + CPU_HZ / 1000;
  }
  return (avr_cycle_count_t)b->next_cycle;
}

/* The bus. */

static void answer(board *b, uint8_t what, uint8_t value) {
  avr_raise_irq(b->twi_in, avr_twi_irq_msg(what, b->selected, value));
}

static void bus_write(board *b, uint8_t value) {
  answer(b, TWI_COND_ACK, 1);
  if (b->has_reg) {
    gyro_write_register(&b->chip, b->reg++, value);
  } else {
    b->reg = value;
    b->has_reg = true;
  }
}

static void bus_read(board *b) {
  answer(b, TWI_COND_READ, gyro_read(&b->chip, b->reg));
  if (b->chip.model->is_latched && b->reg == b->chip.model->rates_reg + 5) {
    avr_raise_irq(b->pin, 0);
  }
  b->reg++;
}

static void bus_message(avr_irq_t *irq, uint32_t value, void *param) {
  board *b = param;
  avr_twi_msg_irq_t message = {.u.v = value};
  (void)irq;
  if (message.u.twi.msg & TWI_COND_STOP) {
    b->selected = 0;
  }
  if (message.u.twi.msg & TWI_COND_START) {
    const bool is_ours = message.u.twi.addr >> 1 == b->chip.model->address && is_plugged(b) && b->held_clocks <= 0.0;
    b->selected = is_ours ? message.u.twi.addr : 0;
    b->has_reg = false;
    if (is_ours) {
      answer(b, TWI_COND_ACK, 1);
    }
  }
  if (b->selected && (message.u.twi.msg & TWI_COND_WRITE)) {
    bus_write(b, message.u.twi.data);
  }
  if (b->selected && (message.u.twi.msg & TWI_COND_READ)) {
    bus_read(b);
  }
}

static void pull_sda(board *b) {
  const bool is_high = b->held_clocks <= 0.0;
  avr_ioport_external_t pull = {.name = 'C', .mask = 1 << 4, .value = (uint8_t)(is_high << 4)};
  avr_ioctl(b->avr, AVR_IOCTL_IOPORT_SET_EXTERNAL('C'), &pull);
  avr_raise_irq(b->sda, is_high);
}

/* A gyro that was cut short waits for the clocks that end its byte, and answers nobody before. */
static void scl_moves(avr_irq_t *irq, uint32_t level, void *param) {
  board *b = param;
  (void)irq;
  if (b->scl && !level && b->held_clocks > 0.0) {
    b->held_clocks -= 1.0;
    pull_sda(b);
  }
  b->scl = level;
}

/* The board. */

static void no_nap(avr_t *avr, avr_cycle_count_t cycles) { (void)avr, (void)cycles; }

static void no_log(avr_t *avr, const int level, const char *format, va_list rest) {
  (void)avr, (void)level, (void)format, (void)rest;
}

static void build(board *b, const char *sketch) {
  elf_firmware_t firmware;
  uint32_t flags = 0;
  memset(&firmware, 0, sizeof firmware);
  avr_global_logger_set(no_log);
  if (elf_read_firmware(sketch, &firmware)) {
    fprintf(stderr, "%s: no ELF file\n", sketch);
    exit(1);
  }
  b->avr = avr_make_mcu_by_name("atmega328p");
  avr_init(b->avr);
  avr_load_firmware(b->avr, &firmware);
  b->avr->frequency = CPU_HZ;
  b->avr->sleep = no_nap;
  avr_ioctl(b->avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
  flags &= ~(uint32_t)(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
  avr_ioctl(b->avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  avr_irq_register_notify(avr_io_getirq(b->avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), uart_byte, b);
  b->twi_in = avr_io_getirq(b->avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_INPUT);
  avr_irq_register_notify(avr_io_getirq(b->avr, AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_OUTPUT), bus_message, b);
  b->pin = avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ('D'), 2);
  b->sda = avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ('C'), 4);
  avr_irq_register_notify(avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ('C'), 5), scl_moves, b);
  pull_sda(b);
  avr_cycle_timer_register(b->avr, 1, gyro_tick, b);
}

static double wall_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void run(board *b) {
  const avr_cycle_count_t end = (avr_cycle_count_t)((b->seconds + SETTLING_MS * 1e-3) * CPU_HZ);
  const double began_s = wall_s();
  avr_cycle_count_t next_look = 0;
  while (b->avr->cycle < end) {
    const int state = avr_run(b->avr);
    if (state == cpu_Done || state == cpu_Crashed) {
      fprintf(stderr, "the sketch ended after %.3f s\n", seconds_now(b));
      exit(1);
    }
    if (b->avr->cycle >= next_look) {
      const double ahead_s = b->speed > 0.0 ? seconds_now(b) / b->speed - (wall_s() - began_s) : 0.0;
      send_out(b);
      next_look = b->avr->cycle + CPU_HZ / 200;
      if (ahead_s > 0.0) {
        usleep((useconds_t)(ahead_s * 1e6));
      }
    }
  }
}

static bool number(const char *word, const char *name, double *value) {
  const size_t length = strlen(name);
  if (strncmp(word, name, length) || word[length] != '=') {
    return false;
  }
  *value = atof(word + length + 1);
  return true;
}

static void option(board *b, const char *word) {
  size_t i;
  if (!strncmp(word, "truth=", 6)) {
    b->truth = fopen(word + 6, "w");
    return;
  }
  for (i = 0; i < sizeof GYRO_MODELS / sizeof *GYRO_MODELS; i++) {
    if (!strncmp(word, "gyro=", 5) && !strcmp(word + 5, GYRO_MODELS[i]->name)) {
      b->chip.model = GYRO_MODELS[i];
      return;
    }
  }
  if (!number(word, "seconds", &b->seconds) && !number(word, "speed", &b->speed) && !number(word, "ppm", &b->ppm) &&
      !number(word, "absent", &b->absent_s) && !number(word, "reset", &b->reset_s) && !number(word, "pin", &b->has_pin) && !number(word, "held", &b->held_clocks) &&
      !number(word, "clip", &b->clips)) {
    fprintf(stderr, "%s: no such option\n", word);
    exit(2);
  }
}

int main(int count, char **words) {
  static board b = {.seconds = 10.0, .ppm = 3000.0, .has_pin = 1.0, .chip = {.model = &MPU6050}, .random = 19};
  double began_s;
  int i;
  for (i = 3; i < count; i++) {
    option(&b, words[i]);
  }
  if (count < 3) {
    fprintf(stderr, "avr_board SKETCH.elf LINK [option=value]...\n");
    return 2;
  }
  gyro_reset(&b.chip);
  build(&b, words[1]);
  open_pty(&b, words[2]);
  wait_for_reader(&b);
  began_s = wall_s();
  run(&b);
  drain(&b);
  unlink(words[2]);
  if (b.truth) {
    fclose(b.truth);
  }
  printf("{\"measured\": %ld, \"rate_hz\": %g, \"range_dps\": %g, \"low_pass_hz\": %g, ", b.measured,
         b.chip.model->rate_hz(&b.chip), b.chip.model->range_dps(&b.chip), b.chip.model->low_pass_hz(&b.chip));
  printf("\"counts_per_g\": %g, \"accel_low_pass_hz\": %g, \"took_s\": %.2f}\n", b.chip.model->counts_per_g(&b.chip),
         b.chip.model->accel_low_pass_hz(&b.chip), wall_s() - began_s);
  return 0;
}
