/* What a 32-bit core declares of Arduino's language, as far as the sketch uses it: to compile against, not to run. */
#pragma once
#include <stddef.h>
#include <stdint.h>

#define IRAM_ATTR __attribute__((section(".iram1")))

enum { LOW, HIGH };
enum { INPUT = 1, OUTPUT = 3, INPUT_PULLUP = 5 };
enum { RISING = 1 };

static const uint8_t SDA = 21;
static const uint8_t SCL = 22;

unsigned long micros();
unsigned long millis();
void delay(uint32_t ms);
void delayMicroseconds(uint32_t us);
void pinMode(uint8_t pin, uint8_t mode);
void digitalWrite(uint8_t pin, uint8_t value);
int digitalRead(uint8_t pin);
void attachInterrupt(uint8_t pin, void (*handler)(), int mode);
void noInterrupts();
void interrupts();
#define digitalPinToInterrupt(pin) (pin)

#define F(text) (text)

struct HardwareSerial {
  void begin(unsigned long baud);
  size_t write(const uint8_t *bytes, size_t count);
  size_t print(const char *text);
  size_t print(double value, int decimals);
  size_t println(const char *text);
};
extern HardwareSerial Serial;
