/* As in component.h. */
#pragma once
#include <cstdint>
namespace esphome {
uint32_t micros();
}  // namespace esphome
