// Runs a policy of your own, a class, in whole episodes beside the gait alone.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "crossgait/backends/registry.h"
#include "crossgait/study/rollout.h"

/// Lowers every parameter of the gait bit by bit.
class Lower final : public crossgait::Policy {
 public:
  explicit Lower(const crossgait::PolicyInterface& interface) : Policy("lower", interface) {}

 private:
  void do_reset(std::uint64_t) noexcept override {}
  void do_act(std::span<const double>, std::span<double> action) noexcept override {
    std::fill(action.begin(), action.end(), -0.05);
  }
};

int main() {
  crossgait::EnvConfig config;
  config.engine = crossgait::available_engines().front();
  config.policy_dt = 0.02;
  config.episode_seconds = 2;
  const auto make = [](const crossgait::PolicyInterface& i) { return std::make_unique<Lower>(i); };
  const std::vector<crossgait::NamedPolicy> policies{{"lower", make}, crossgait::find_policy("zero")};
  std::puts(describe(roll_out(config, policies, {.episodes = 2})).c_str());
}
