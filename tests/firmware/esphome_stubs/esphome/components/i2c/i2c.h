/* As in component.h. */
#pragma once
#include <cstdint>
#define LOG_I2C_DEVICE(device) (void)(device)
namespace esphome {
namespace i2c {
class I2CDevice {
 public:
  bool read_byte(uint8_t a_register, uint8_t *data);
  bool read_bytes(uint8_t a_register, uint8_t *data, uint8_t len);
  bool write_byte(uint8_t a_register, uint8_t data) const;
};
}  // namespace i2c
}  // namespace esphome
