/* Encoder of gyrodrift's native protocol: HELLO with SAMPLE or SAMPLE3, framed by COBS, with a CRC.

   For C99 and C++, without allocation, tables, 64-bit numbers or stdio. It needs the frame and 8 bytes of stack, two's
   complement and IEEE floats; any byte order works. Lengths are in bytes.

   Send HELLO at boot and once a second, so that a reader can join at any time, and SAMPLE for each measurement:

       uint8_t frame[GYRODRIFT_LONGEST_FRAME];
       write(frame, gyrodrift_hello_frame(frame, &hello));
       write(frame, gyrodrift_sample_frame(frame, &sample));

   A device with three gyro axes and an accelerometer sends HELLO of version 2 and SAMPLE3 instead:

       write(frame, gyrodrift_hello3_frame(frame, &hello, mps2_per_lsb));
       write(frame, gyrodrift_sample3_frame(frame, &sample3));

   A device that runs a filter sends HELLO of version 3, and YAW right after the SAMPLE or SAMPLE3 that it belongs to:

       write(frame, gyrodrift_hello_filter_frame(frame, &hello, axes, mps2_per_lsb, GYRODRIFT_FILTER_RESTLEVEL));
       write(frame, gyrodrift_yaw_frame(frame, &yaw));
*/
#ifndef GYRODRIFT_NATIVE_H
#define GYRODRIFT_NATIVE_H

#include <stdint.h>
#include <string.h>

#define GYRODRIFT_HELLO_FRAME 32 /* bytes on the wire, with the delimiter */
#define GYRODRIFT_SAMPLE_FRAME 20
#define GYRODRIFT_HELLO3_FRAME 37
#define GYRODRIFT_SAMPLE3_FRAME 30
#define GYRODRIFT_HELLO_FILTER_FRAME 38
#define GYRODRIFT_YAW_FRAME 24
#define GYRODRIFT_LONGEST_FRAME GYRODRIFT_HELLO_FILTER_FRAME

#define GYRODRIFT_DEVICE_ID_BYTES 16

#define GYRODRIFT_ENCODER_VALID 0x01 /* flags of a sample */
#define GYRODRIFT_TEMPERATURE_VALID 0x02
#define GYRODRIFT_RATE_CLIPPED 0x04
#define GYRODRIFT_ACCEL_VALID 0x10 /* of SAMPLE3 alone */
#define GYRODRIFT_ACCEL_CLIPPED 0x40

#define GYRODRIFT_FILTER_NONE 0 /* filter of HELLO version 3 */
#define GYRODRIFT_FILTER_HDR 1
#define GYRODRIFT_FILTER_RESTLEVEL 2
#define GYRODRIFT_FILTER_ATTITUDE 3

#define GYRODRIFT_HELLO_TYPE 0x01
#define GYRODRIFT_SAMPLE_TYPE 0x02
#define GYRODRIFT_SAMPLE3_TYPE 0x03
#define GYRODRIFT_YAW_TYPE 0x04
#define GYRODRIFT_VERSION 1
#define GYRODRIFT_AXES_VERSION 2
#define GYRODRIFT_FILTER_VERSION 3
#define GYRODRIFT_AXES 3

typedef struct {
  uint16_t sample_rate_hz;
  float dps_per_lsb;     /* deg/s of one count of rate_raw; above 0 */
  uint32_t encoder_cpr;  /* counts per turn; 0 without an encoder */
  const char *device_id; /* ASCII, zero-terminated; cut after 16 characters */
} gyrodrift_hello;

typedef struct {
  uint8_t flags;
  uint16_t seq;           /* counts measurements, also those not sent; wraps */
  uint32_t t_us;          /* device clock at the measurement, in microseconds; wraps */
  int16_t rate_raw;       /* counter-clockwise is positive */
  int16_t temp_centi_c;   /* hundredths of a degree C */
  int32_t encoder_counts; /* wraps */
} gyrodrift_sample;

/* The axes are right-handed, with z up when the sensor lies flat. */
typedef struct {
  uint8_t flags;
  uint16_t seq;
  uint32_t t_us;
  int16_t gyro_raw[3];    /* about x, y and z; counter-clockwise is positive */
  int16_t accel_raw[3];   /* at rest, the axis that points up reads 1 g */
  int16_t temp_centi_c;
  int32_t encoder_counts;
} gyrodrift_sample3;

/* Result of the filter in the device; seq and t_us are those of the sample that it belongs to. */
typedef struct {
  uint16_t seq;
  uint32_t t_us;
  float yaw_deg;       /* unwrapped; counter-clockwise is positive */
  float yaw_sigma_deg; /* NAN if the filter has none */
  float bias_dps;      /* estimated drift */
} gyrodrift_yaw;

/* State of a frame. `run` is the index of the distance to the next zero (COBS, Cheshire and Baker 1999). */
typedef struct {
  uint8_t *frame;
  uint8_t at;
  uint8_t run;
  uint16_t crc;
} gyrodrift_writer;

static inline void gyrodrift_stuff(gyrodrift_writer *writer, uint8_t byte) {
  if (byte == 0) {
    writer->frame[writer->run] = (uint8_t)(writer->at - writer->run);
    writer->run = writer->at;
  } else {
    writer->frame[writer->at] = byte;
  }
  writer->at++;
}

/* CRC-16/CCITT-FALSE by shifts: a table of 512 bytes would take a quarter of an ATmega328's memory. */
static inline uint16_t gyrodrift_crc(uint16_t crc, uint8_t byte) {
  crc = (uint16_t)((uint16_t)(crc >> 8) | (uint16_t)(crc << 8));
  crc = (uint16_t)(crc ^ byte);
  crc = (uint16_t)(crc ^ (uint16_t)((crc & 0xFF) >> 4));
  crc = (uint16_t)(crc ^ (uint16_t)(crc << 12));
  return (uint16_t)(crc ^ (uint16_t)((crc & 0xFF) << 5));
}

static inline void gyrodrift_put8(gyrodrift_writer *writer, uint8_t byte) {
  writer->crc = gyrodrift_crc(writer->crc, byte);
  gyrodrift_stuff(writer, byte);
}

static inline void gyrodrift_put16(gyrodrift_writer *writer, uint16_t value) {
  gyrodrift_put8(writer, (uint8_t)(value & 0xFF));
  gyrodrift_put8(writer, (uint8_t)(value >> 8));
}

static inline void gyrodrift_put32(gyrodrift_writer *writer, uint32_t value) {
  gyrodrift_put16(writer, (uint16_t)(value & 0xFFFF));
  gyrodrift_put16(writer, (uint16_t)(value >> 16));
}

static inline void gyrodrift_begin(gyrodrift_writer *writer, uint8_t *frame, uint8_t type) {
  writer->frame = frame;
  writer->at = 1;
  writer->run = 0;
  writer->crc = 0xFFFF;
  gyrodrift_put8(writer, type);
}

static inline uint8_t gyrodrift_end(gyrodrift_writer *writer) {
  const uint16_t crc = writer->crc;
  gyrodrift_put16(writer, crc);
  writer->frame[writer->run] = (uint8_t)(writer->at - writer->run);
  writer->frame[writer->at] = 0;
  return (uint8_t)(writer->at + 1);
}

static inline void gyrodrift_put_float(gyrodrift_writer *writer, float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  gyrodrift_put32(writer, bits);
}

/* The fields that all versions of HELLO share. */
static inline void gyrodrift_put_hello(gyrodrift_writer *writer, uint8_t *frame, const gyrodrift_hello *hello,
                                       uint8_t version) {
  const char *letter = hello->device_id;
  uint8_t i;
  gyrodrift_begin(writer, frame, GYRODRIFT_HELLO_TYPE);
  gyrodrift_put8(writer, version);
  gyrodrift_put16(writer, hello->sample_rate_hz);
  gyrodrift_put_float(writer, hello->dps_per_lsb);
  gyrodrift_put32(writer, hello->encoder_cpr);
  for (i = 0; i < GYRODRIFT_DEVICE_ID_BYTES; i++) {
    gyrodrift_put8(writer, (uint8_t)*letter);
    if (*letter != '\0') {
      letter++;
    }
  }
}

/* Write HELLO into `frame` (GYRODRIFT_HELLO_FRAME bytes); return its length. */
static inline uint8_t gyrodrift_hello_frame(uint8_t *frame, const gyrodrift_hello *hello) {
  gyrodrift_writer writer;
  gyrodrift_put_hello(&writer, frame, hello, GYRODRIFT_VERSION);
  return gyrodrift_end(&writer);
}

/* Write HELLO of three axes into `frame` (GYRODRIFT_HELLO3_FRAME bytes); return its length.
   `mps2_per_lsb` is one count of accel_raw in m/s^2, or 0 without an accelerometer. */
static inline uint8_t gyrodrift_hello3_frame(uint8_t *frame, const gyrodrift_hello *hello, float mps2_per_lsb) {
  gyrodrift_writer writer;
  gyrodrift_put_hello(&writer, frame, hello, GYRODRIFT_AXES_VERSION);
  gyrodrift_put_float(&writer, mps2_per_lsb);
  gyrodrift_put8(&writer, GYRODRIFT_AXES);
  return gyrodrift_end(&writer);
}

/* Write HELLO of a device that runs a filter into `frame` (GYRODRIFT_HELLO_FILTER_FRAME bytes); return its length.
   `axes` is 1 for SAMPLE and 3 for SAMPLE3; `mps2_per_lsb` is 0 without an accelerometer. */
static inline uint8_t gyrodrift_hello_filter_frame(uint8_t *frame, const gyrodrift_hello *hello, uint8_t axes,
                                                   float mps2_per_lsb, uint8_t filter) {
  gyrodrift_writer writer;
  gyrodrift_put_hello(&writer, frame, hello, GYRODRIFT_FILTER_VERSION);
  gyrodrift_put_float(&writer, mps2_per_lsb);
  gyrodrift_put8(&writer, axes);
  gyrodrift_put8(&writer, filter);
  return gyrodrift_end(&writer);
}

/* Write SAMPLE into `frame` (GYRODRIFT_SAMPLE_FRAME bytes); return its length. */
static inline uint8_t gyrodrift_sample_frame(uint8_t *frame, const gyrodrift_sample *sample) {
  gyrodrift_writer writer;
  gyrodrift_begin(&writer, frame, GYRODRIFT_SAMPLE_TYPE);
  gyrodrift_put8(&writer, sample->flags);
  gyrodrift_put16(&writer, sample->seq);
  gyrodrift_put32(&writer, sample->t_us);
  gyrodrift_put16(&writer, (uint16_t)sample->rate_raw);
  gyrodrift_put16(&writer, (uint16_t)sample->temp_centi_c);
  gyrodrift_put32(&writer, (uint32_t)sample->encoder_counts);
  return gyrodrift_end(&writer);
}

/* Write SAMPLE3 into `frame` (GYRODRIFT_SAMPLE3_FRAME bytes); return its length. */
static inline uint8_t gyrodrift_sample3_frame(uint8_t *frame, const gyrodrift_sample3 *sample) {
  gyrodrift_writer writer;
  uint8_t axis;
  gyrodrift_begin(&writer, frame, GYRODRIFT_SAMPLE3_TYPE);
  gyrodrift_put8(&writer, sample->flags);
  gyrodrift_put16(&writer, sample->seq);
  gyrodrift_put32(&writer, sample->t_us);
  for (axis = 0; axis < GYRODRIFT_AXES; axis++) {
    gyrodrift_put16(&writer, (uint16_t)sample->gyro_raw[axis]);
  }
  for (axis = 0; axis < GYRODRIFT_AXES; axis++) {
    gyrodrift_put16(&writer, (uint16_t)sample->accel_raw[axis]);
  }
  gyrodrift_put16(&writer, (uint16_t)sample->temp_centi_c);
  gyrodrift_put32(&writer, (uint32_t)sample->encoder_counts);
  return gyrodrift_end(&writer);
}

/* Write YAW into `frame` (GYRODRIFT_YAW_FRAME bytes); return its length. Its flags are reserved and 0. */
static inline uint8_t gyrodrift_yaw_frame(uint8_t *frame, const gyrodrift_yaw *yaw) {
  gyrodrift_writer writer;
  gyrodrift_begin(&writer, frame, GYRODRIFT_YAW_TYPE);
  gyrodrift_put8(&writer, 0);
  gyrodrift_put16(&writer, yaw->seq);
  gyrodrift_put32(&writer, yaw->t_us);
  gyrodrift_put_float(&writer, yaw->yaw_deg);
  gyrodrift_put_float(&writer, yaw->yaw_sigma_deg);
  gyrodrift_put_float(&writer, yaw->bias_dps);
  return gyrodrift_end(&writer);
}

#endif
