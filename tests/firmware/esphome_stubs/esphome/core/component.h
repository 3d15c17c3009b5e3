/* What ESPHome 2026.6 declares of its components, as far as gyrodrift uses it: to compile against, not to run. */
#pragma once
#include <cmath>
#include <cstdint>

namespace esphome {
namespace setup_priority {
extern const float DATA;
}
class Component {
 public:
  virtual ~Component() = default;
  virtual void setup() {}
  virtual void loop() {}
  virtual void dump_config() {}
  virtual float get_setup_priority() const { return 0.0f; }
  void mark_failed();
  bool is_failed() const;
  void status_set_warning();
  void status_clear_warning();
};
class PollingComponent : public Component {
 public:
  virtual void update() = 0;
};
}  // namespace esphome
