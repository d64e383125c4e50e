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
  steps_ = first_ = next_ = 0;
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
    if (samples_.empty())
      samples_.assign(static_cast<std::size_t>(steps_in(kKept, control_dt_) / sample_steps_ + 1),
                      {0, std::vector<TraceSample>(instances.size())});
    Samples& now = samples(next_++);
    now.step = steps_;
    for (std::size_t i = 0; i < instances.size(); ++i)
      now.of[i] = TraceSample(instances[i]->world(), instances[i]->targets());
    while (samples(first_).step < oldest) ++first_;
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
  while (next_ > first_ && samples(next_ - 1).step > steps_) --next_;
}

std::vector<Trace> SessionHistory::traces() const {
  std::vector<Trace> traces(samples_.empty() ? 0 : samples_.front().of.size());
  for (std::int64_t k = first_; k < next_; ++k) {
    for (std::size_t i = 0; i < traces.size(); ++i) {
      const TraceSample& sample = samples(k).of[i];
      // Whose time stands still has ended, or made this step with the one before.
      if (traces[i].empty() || sample.state.time > traces[i].back().state.time) traces[i].push_back(sample);
    }
  }
  return traces;
}

}  // namespace crossgait
