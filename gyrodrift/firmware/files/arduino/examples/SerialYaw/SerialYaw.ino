// Yaw of a gyro on the serial monitor, at 115200 baud, with its standard deviation.
//
// Wires from a GY-521 (MPU-6050) to an Uno: VCC to 5V, GND to GND, SCL to A5, SDA to A4. Leave it still for a few
// seconds, then turn it by hand. At each rest the filter learns the bias of the gyro.

#include <Wire.h>
#include <gyrodrift.h>

static const uint8_t ADDRESS = 0x68; // 0x69 if AD0 is high
static const uint32_t SAMPLE_US = 10000;
static const uint32_t LINE_MS = 200;
static const float COUNTS_PER_DPS = 131.0f; // at 250 deg/s

// An Uno has just enough flash for restlevel. A Leonardo has not, and runs HDR, which has no standard deviation.
#if defined(__AVR_ATmega32U4__)
static gyrodrift::Hdr filter;
static void print_sigma() {}
#else
static gyrodrift::Restlevel filter;
static void print_sigma() {
  Serial.print(F(" +- "));
  Serial.print(filter.yaw_sigma_deg(), 2);
}
#endif

static uint32_t sample_us, line_ms;
static bool is_there;

static bool write_register(uint8_t reg, uint8_t value) {
  Wire.beginTransmission(ADDRESS);
  Wire.write(reg);
  Wire.write(value);
  return Wire.endTransmission() == 0;
}

static bool start_gyro() {
  return write_register(0x6B, 0x01)     // PWR_MGMT_1: awake, clock of the gyro
         && write_register(0x1A, 0x03)  // CONFIG: low-pass of 42 Hz
         && write_register(0x1B, 0x00); // GYRO_CONFIG: 250 deg/s
}

static bool read_rate(float *rate_dps) {
  Wire.beginTransmission(ADDRESS);
  Wire.write(0x47); // GYRO_ZOUT_H
  if (Wire.endTransmission(false) != 0 || Wire.requestFrom(ADDRESS, (uint8_t)2) != 2) {
    return false;
  }
  const uint8_t high = (uint8_t)Wire.read();
  const uint8_t low = (uint8_t)Wire.read();
  *rate_dps = (float)(int16_t)((uint16_t)high << 8 | low) / COUNTS_PER_DPS;
  return true;
}

static void print_yaw() {
  if (!is_there) {
    Serial.println(F("no gyro at this address: check VCC, GND, SCL and SDA"));
    is_there = start_gyro();
    return;
  }
  Serial.print(F("yaw "));
  Serial.print(filter.yaw_deg(), 2);
  print_sigma();
  Serial.print(F(" deg, bias "));
  Serial.print(filter.bias_dps(), 3);
  Serial.println(F(" deg/s"));
}

void setup() {
  Serial.begin(115200);
  Wire.begin();
  Wire.setClock(400000);
  is_there = start_gyro();
}

void loop() {
  const uint32_t now_us = micros();
  float rate_dps = 0.0f;
  if (is_there && now_us - sample_us >= SAMPLE_US) {
    sample_us = now_us;
    is_there = read_rate(&rate_dps);
    if (is_there) {
      filter.update_us(now_us, rate_dps);
    }
  } else {
    filter.work(); /* a portion of 2 ms at most, so that no sample waits */
  }
  if (millis() - line_ms >= LINE_MS) {
    line_ms = millis();
    print_yaw();
  }
}
