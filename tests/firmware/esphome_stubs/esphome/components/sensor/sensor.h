/* As in component.h. */
#pragma once
namespace esphome {
namespace sensor {
class Sensor {
 public:
  void publish_state(float state);
};
}  // namespace sensor
}  // namespace esphome
