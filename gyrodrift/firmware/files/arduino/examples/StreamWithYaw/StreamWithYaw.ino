// Sends each rate of an MPU-6050 to `gyrodrift serve` on a computer, with the yaw of the filter on this board beside it.
//
// Wires from a GY-521 to an Uno: VCC to 5V, GND to GND, SCL to A5, SDA to A4, INT to 2. `serve` shows its own yaw as
// yaw_deg and that of this board as device_yaw_deg; `record` keeps both, and `compare` judges both.

#include <Wire.h>
#include <gyrodrift.h>
#include <gyrodrift_native.h>

static const uint32_t BAUD = 115200;
static const uint8_t ADDRESS = 0x68; // 0x69 if AD0 is high
static const uint16_t SAMPLE_RATE_HZ = 100;
static const float DPS_PER_LSB = 1.0f / 131.0f; // at 250 deg/s
static const uint32_t HELLO_MS = 1000;
static const uint32_t SILENCE_MS = 300; // then the sensor is set up again

// A pin with interrupts; the same as in the other sketches.
#if defined(ESP32)
static const uint8_t DATA_READY_PIN = 19;
#elif defined(ESP8266)
static const uint8_t DATA_READY_PIN = 14;
#elif defined(ARDUINO_ARCH_RP2040)
static const uint8_t DATA_READY_PIN = 6;
#elif defined(__AVR_ATmega32U4__)
static const uint8_t DATA_READY_PIN = 7;
#else
static const uint8_t DATA_READY_PIN = 2;
#endif

#if !defined(IRAM_ATTR)
#define IRAM_ATTR // an ESP needs interrupt handlers in RAM
#endif

// Restlevel is the better filter, but needs a faster chip than an AVR. HDR has no standard deviation.
#if defined(__AVR__)
static gyrodrift::Hdr filter;
static const uint8_t FILTER = GYRODRIFT_FILTER_HDR;
static float sigma_deg() { return NAN; }
#else
static gyrodrift::Restlevel filter;
static const uint8_t FILTER = GYRODRIFT_FILTER_RESTLEVEL;
static float sigma_deg() { return filter.yaw_sigma_deg(); }
#endif

static volatile uint16_t ready_seq;
static volatile uint32_t ready_us;
static uint16_t seq; // of the last measurement read
static uint32_t hello_ms, sample_ms;
static bool is_there;

static void IRAM_ATTR on_data_ready() {
  ready_us = micros();
  ready_seq++;
}

static bool write_register(uint8_t reg, uint8_t value) {
  Wire.beginTransmission(ADDRESS);
  Wire.write(reg);
  Wire.write(value);
  return Wire.endTransmission() == 0;
}

static bool start_gyro() {
  return write_register(0x6B, 0x01)     // PWR_MGMT_1: awake, clock of the gyro
         && write_register(0x1A, 0x03)  // CONFIG: low-pass of 42 Hz, internal rate 1 kHz
         && write_register(0x19, 0x09)  // SMPLRT_DIV: 1 kHz / (1 + 9)
         && write_register(0x1B, 0x00)  // GYRO_CONFIG: 250 deg/s
         && write_register(0x37, 0x00)  // INT_PIN_CFG: a pulse of 50 us, high
         && write_register(0x38, 0x01); // INT_ENABLE: data ready
}

static void send_hello() {
  const gyrodrift_hello hello = {SAMPLE_RATE_HZ, DPS_PER_LSB, 0, is_there ? "MPU-6050 250/42" : "no gyro on I2C"};
  uint8_t frame[GYRODRIFT_LONGEST_FRAME];
  Serial.write(frame, gyrodrift_hello_filter_frame(frame, &hello, 1, 0.0f, FILTER));
  hello_ms = millis();
}

// Temperature, x, y and z follow each other; x and y are not used.
static bool read_gyro(int16_t *temp_raw, int16_t *rate_raw) {
  uint8_t bytes[8];
  Wire.beginTransmission(ADDRESS);
  Wire.write(0x41); // TEMP_OUT_H
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(ADDRESS, (uint8_t)sizeof bytes) != sizeof bytes) {
    return false;
  }
  for (uint8_t i = 0; i < sizeof bytes; i++) {
    bytes[i] = (uint8_t)Wire.read();
  }
  *temp_raw = (int16_t)((uint16_t)bytes[0] << 8 | bytes[1]);
  *rate_raw = (int16_t)((uint16_t)bytes[6] << 8 | bytes[7]);
  return true;
}

static void send_sample(uint32_t t_us, int16_t temp_raw, int16_t rate_raw) {
  const bool is_clipped = rate_raw == INT16_MAX || rate_raw == INT16_MIN;
  const uint8_t flags = GYRODRIFT_TEMPERATURE_VALID | (is_clipped ? GYRODRIFT_RATE_CLIPPED : 0);
  const int16_t temp_centi_c = (int16_t)(100.0f * ((float)temp_raw / 340.0f + 36.53f) + 0.5f);
  const gyrodrift_sample sample = {flags, seq, t_us, rate_raw, temp_centi_c, 0};
  uint8_t frame[GYRODRIFT_LONGEST_FRAME];
  Serial.write(frame, gyrodrift_sample_frame(frame, &sample));
  filter.update_us(t_us, (float)rate_raw * DPS_PER_LSB);
  const gyrodrift_yaw yaw = {seq, t_us, filter.yaw_deg(), sigma_deg(), filter.bias_dps()};
  Serial.write(frame, gyrodrift_yaw_frame(frame, &yaw));
}

static void take_sample() {
  noInterrupts();
  const uint16_t measured_seq = ready_seq;
  const uint32_t measured_us = ready_us;
  interrupts();
  int16_t temp_raw, rate_raw;
  if (measured_seq == seq) {
    return;
  }
  seq = measured_seq;
  if (!read_gyro(&temp_raw, &rate_raw)) {
    return;
  }
  noInterrupts();
  const bool is_overtaken = ready_seq != seq; // by the next measurement: rate and time may not match
  interrupts();
  if (!is_overtaken) {
    send_sample(measured_us, temp_raw, rate_raw);
    sample_ms = millis();
  }
}

void setup() {
  Serial.begin(BAUD);
  Wire.begin();
  Wire.setClock(400000);
  pinMode(DATA_READY_PIN, INPUT);
  attachInterrupt(digitalPinToInterrupt(DATA_READY_PIN), on_data_ready, RISING);
  is_there = start_gyro();
  send_hello();
}

void loop() {
  take_sample();
  if (millis() - hello_ms >= HELLO_MS) {
    send_hello();
  }
  if (millis() - sample_ms >= SILENCE_MS) {
    sample_ms = millis();
    is_there = start_gyro();
  }
}
