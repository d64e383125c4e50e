#include "view/session_history.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

constexpr double kKept = 60, kMoment = 0.1, kSample = 0.02;  // s

std::int64_t steps_in(double seconds, double control_dt) {
  return std::max<std::int64_t>(1, std::llround(seconds / control_dt));
}

}  // namespace

SessionHistory::SessionHistory(double control_dt)
    : control_dt_(control_dt),
      moment_steps_(steps_in(kMoment, control_dt)),
      sample_steps_(steps_in(kSample, control_dt)) {}

void SessionHistory::forget() noexcept {
  moments_.clear();
  samples_.clear();
  steps_ = 0;
}

void SessionHistory::add(const RobotInstances& instances) {
  const std::int64_t oldest = ++steps_ - steps_in(kKept, control_dt_);
  if (steps_ % moment_steps_ == 1 || moment_steps_ == 1) {
    Moment moment{steps_, {}};
    for (const auto& instance : instances) moment.saved.push_back(instance->save());
    moments_.push_back(std::move(moment));
    if (moments_.front().step < oldest) moments_.pop_front();
  }
  if (steps_ % sample_steps_ == 0) {
    Samples samples{steps_, {}};
    for (const auto& instance : instances) samples.of.emplace_back(instance->world(), instance->targets());
    samples_.push_back(std::move(samples));
    if (samples_.front().step < oldest) samples_.pop_front();
  }
}

double SessionHistory::seconds() const noexcept {
  return moments_.empty() ? 0 : static_cast<double>(steps_ - moments_.front().step) * control_dt_;
}

void SessionHistory::back(double seconds, RobotInstances& instances) {
  if (moments_.empty()) return;
  const std::int64_t then = steps_ - std::llround(seconds / control_dt_);
  while (moments_.size() > 1 && moments_.back().step > then) moments_.pop_back();
  const Moment& moment = moments_.back();
  for (std::size_t i = 0; i < instances.size(); ++i) instances[i]->restore(*moment.saved[i]);
  steps_ = moment.step;
  while (!samples_.empty() && samples_.back().step > steps_) samples_.pop_back();
}

std::vector<Trace> SessionHistory::traces() const {
  std::vector<Trace> traces(samples_.empty() ? 0 : samples_.front().of.size());
  for (const Samples& samples : samples_) {
    for (std::size_t i = 0; i < traces.size(); ++i) {
      // Whose time stands still has ended, or made this step with the one before.
      const bool is_new = traces[i].empty() || samples.of[i].state.time > traces[i].back().state.time;
      if (is_new) traces[i].push_back(samples.of[i]);
    }
  }
  return traces;
}

}  // namespace crossgait
