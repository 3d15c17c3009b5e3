/* As in component.h. */
#pragma once
namespace esphome {
class HighFrequencyLoopRequester {
 public:
  void start();
  void stop();
};
}  // namespace esphome
