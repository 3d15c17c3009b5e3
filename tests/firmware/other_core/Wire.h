/* Wire of a 32-bit core: lengths are size_t, and there is no timeout to set. */
#pragma once
#include <stddef.h>
#include <stdint.h>

struct TwoWire {
  bool begin();
  bool setClock(uint32_t hz);
  void beginTransmission(uint8_t address);
  uint8_t endTransmission();
  uint8_t endTransmission(bool stops);
  size_t requestFrom(uint8_t address, size_t count);
  size_t write(uint8_t byte);
  int read();
};
extern TwoWire Wire;
