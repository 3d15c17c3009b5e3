// Gyro on I2C for gyrodrift: sends rates, accelerations and temperature in the native protocol.
//
// The data-ready pin of the sensor starts an interrupt, which reads the clock. So traffic on I2C or the serial line does
// not shift sample times. `seq` counts missed measurements, too.

#include <Wire.h>

#include "gyro_sensors.h"
#include "gyrodrift_native.h"

#if defined(__AVR__)
#include <avr/sleep.h>
#endif

// Settings of your robot.
static const uint32_t BAUD = 115200;
static const uint8_t AXIS = 2;            // axis that points up: 0 x, 1 y, 2 z; it is sent as z
static const bool IS_UPSIDE_DOWN = false; // true if it points down
static const bool HAS_ALL_AXES = true;    // false: only the yaw rate, for lines slower than 115200 baud

// A pin with interrupts; the same as in docs/firmware/README.md.
#if defined(ESP32)
static const uint8_t DATA_READY_PIN = 19;
#elif defined(ESP8266)
static const uint8_t DATA_READY_PIN = 14;
#elif defined(ARDUINO_ARCH_RP2040)
static const uint8_t DATA_READY_PIN = 6;
#elif defined(__AVR_ATmega32U4__)
static const uint8_t DATA_READY_PIN = 7; // 2 and 3 of a Leonardo are its I2C
#else
static const uint8_t DATA_READY_PIN = 2;
#endif

static const uint32_t I2C_HZ = 400000;
static const uint16_t RESET_MS = 100; // of the MPU-6050, the slowest
static const uint32_t HELLO_US = 1000000;
static const uint32_t SILENCE_MS = 300; // then the sensor is set up again: it lost its settings or its cable

#if !defined(IRAM_ATTR)
#define IRAM_ATTR // an ESP needs interrupt handlers in RAM
#endif

static volatile uint16_t ready_seq;
static volatile uint32_t ready_us;

static const gyro_sensor *sensor;
static uint8_t address;
static uint16_t seq; // of the last measurement read
static uint32_t hello_us;
static uint32_t sample_ms;
static uint8_t quiet_starts; // starts of the sensor since its last measurement

static void IRAM_ATTR on_data_ready() {
  ready_us = micros();
  ready_seq++;
}

static bool write_register(uint8_t at, gyro_write write) {
  Wire.beginTransmission(at);
  Wire.write(write.reg);
  Wire.write(write.value);
  return Wire.endTransmission() == 0;
}

static bool read_registers(uint8_t at, uint8_t reg, uint8_t *into, uint8_t count) {
  Wire.beginTransmission(at);
  Wire.write(reg);
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(at, count) != count) {
    return false;
  }
  for (uint8_t i = 0; i < count; i++) {
    into[i] = (uint8_t)Wire.read();
  }
  return true;
}

// Clock out a sensor that holds SDA low, because the board was reset during a transfer.
static void free_bus() {
  pinMode(SDA, INPUT_PULLUP);
  for (uint8_t i = 0; i < 9 && digitalRead(SDA) == LOW; i++) {
    digitalWrite(SCL, LOW);
    pinMode(SCL, OUTPUT);
    delayMicroseconds(5);
    pinMode(SCL, INPUT_PULLUP);
    delayMicroseconds(5);
  }
}

static bool is_there(const gyro_sensor &candidate, uint8_t at) {
  uint8_t who = 0;
  return read_registers(at, candidate.who_reg, &who, 1) && who == candidate.who;
}

static bool start(const gyro_sensor &candidate, uint8_t at) {
  for (uint8_t i = 0; i < candidate.write_count; i++) {
    if (!write_register(at, candidate.writes[i])) {
      return false;
    }
    if (i == 0) {
      delay(RESET_MS);
    }
  }
  return true;
}

// Sensor name, or the wiring fault that the log of gyrodrift then shows.
static const char *name() {
  if (sensor == NULL) {
    return "no gyro on I2C";
  }
  return quiet_starts > 2 ? "INT pin is quiet" : sensor->id;
}

static void send_hello() {
  gyrodrift_hello hello = {0, 1.0f, 0, name()};
  if (sensor != NULL) {
    hello.sample_rate_hz = sensor->sample_rate_hz;
    hello.dps_per_lsb = sensor->dps_per_lsb;
  }
  uint8_t frame[GYRODRIFT_LONGEST_FRAME];
  const float mps2_per_lsb = sensor == NULL ? 0.0f : sensor->mps2_per_lsb;
  Serial.write(frame, HAS_ALL_AXES ? gyrodrift_hello3_frame(frame, &hello, mps2_per_lsb)
                                   : gyrodrift_hello_frame(frame, &hello));
}

static void find_sensor() {
  sensor = NULL;
  for (uint8_t i = 0; i < GYRO_SENSOR_COUNT && sensor == NULL; i++) {
    for (uint8_t j = 0; j < 2 && sensor == NULL; j++) {
      address = GYRO_SENSORS[i].addresses[j];
      if (is_there(GYRO_SENSORS[i], address) && start(GYRO_SENSORS[i], address)) {
        sensor = &GYRO_SENSORS[i];
      }
    }
  }
  if (quiet_starts < UINT8_MAX) {
    quiet_starts++;
  }
  send_hello(); // before samples with a new scale
  sample_ms = millis();
}

static int16_t value_at(const uint8_t *bytes) {
  const uint8_t high = sensor->is_big_endian ? bytes[0] : bytes[1];
  const uint8_t low = sensor->is_big_endian ? bytes[1] : bytes[0];
  return (int16_t)((uint16_t)high << 8 | low);
}

static int16_t centi_c(int16_t raw) {
  const float value = 100.0f * ((float)raw * sensor->c_per_lsb + sensor->c_at_zero);
  return (int16_t)(value < 0.0f ? value - 0.5f : value + 0.5f);
}

static bool is_at_end(int16_t raw) { return raw == INT16_MAX || raw == INT16_MIN; }

// Values of x, y and z in the frame whose z axis points up; true if one is at the end of its range. AXIS becomes z by a
// cyclic exchange. Upside down is half a turn about x. Both keep the frame right-handed.
static bool read_axes(const uint8_t *bytes, int16_t *raw) {
  bool is_clipped = false;
  for (uint8_t i = 0; i < GYRODRIFT_AXES; i++) {
    const int16_t value = value_at(bytes + 2 * ((AXIS + 1 + i) % GYRODRIFT_AXES));
    is_clipped |= is_at_end(value);
    raw[i] = !IS_UPSIDE_DOWN || i == 0 ? value : value == INT16_MIN ? INT16_MAX : (int16_t)-value;
  }
  return is_clipped;
}

static void send_sample(uint32_t t_us, const uint8_t *burst) {
  gyrodrift_sample3 sample;
  sample.flags = GYRODRIFT_TEMPERATURE_VALID | GYRODRIFT_ACCEL_VALID;
  sample.seq = seq;
  sample.t_us = t_us;
  sample.temp_centi_c = centi_c(value_at(burst + sensor->temp_at));
  sample.encoder_counts = 0;
  if (read_axes(burst + sensor->rates_at, sample.gyro_raw)) {
    sample.flags |= GYRODRIFT_RATE_CLIPPED;
  }
  if (read_axes(burst + sensor->accels_at, sample.accel_raw)) {
    sample.flags |= GYRODRIFT_ACCEL_CLIPPED;
  }
  uint8_t frame[GYRODRIFT_LONGEST_FRAME];
  if (HAS_ALL_AXES) {
    Serial.write(frame, gyrodrift_sample3_frame(frame, &sample));
    return;
  }
  const bool is_clipped = is_at_end(value_at(burst + sensor->rates_at + 2 * AXIS));
  const uint8_t flags = GYRODRIFT_TEMPERATURE_VALID | (is_clipped ? GYRODRIFT_RATE_CLIPPED : 0);
  const gyrodrift_sample yaw = {flags, seq, t_us, sample.gyro_raw[2], sample.temp_centi_c, 0};
  Serial.write(frame, gyrodrift_sample_frame(frame, &yaw));
}

static void take_sample() {
  noInterrupts();
  const uint16_t measured_seq = ready_seq;
  const uint32_t measured_us = ready_us;
  interrupts();
  if (measured_seq == seq) {
    return;
  }
  seq = measured_seq;
  uint8_t burst[GYRO_BURST_BYTES];
  if (!read_registers(address, sensor->burst_reg, burst, sizeof burst)) {
    return;
  }
  noInterrupts();
  const bool is_overtaken = ready_seq != seq; // overtaken by the next measurement: rate and time may not match
  interrupts();
  if (is_overtaken) {
    return;
  }
  if (quiet_starts > 2) {
    quiet_starts = 0;
    send_hello();
  }
  quiet_starts = 0;
  send_sample(measured_us, burst);
  sample_ms = millis();
}

void setup() {
  Serial.begin(BAUD);
  free_bus();
  Wire.begin();
  Wire.setClock(I2C_HZ);
#if defined(WIRE_HAS_TIMEOUT)
  Wire.setWireTimeout(25000, true);
#endif
  pinMode(DATA_READY_PIN, INPUT);
  attachInterrupt(digitalPinToInterrupt(DATA_READY_PIN), on_data_ready, RISING);
  hello_us = micros();
  find_sensor();
}

void loop() {
  if (micros() - hello_us >= HELLO_US) {
    hello_us += HELLO_US;
    send_hello();
  }
  if (sensor != NULL) {
    take_sample();
  }
  if (millis() - sample_ms >= SILENCE_MS) {
    find_sensor();
  }
#if defined(__AVR__)
  set_sleep_mode(SLEEP_MODE_IDLE); // for at most 1 ms, until the next interrupt: keeps the board beside the gyro cool
  sleep_mode();
#endif
}
