#include "view/live_view.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t kMaxOrders = 64;
/// From one frame to the next, s.
constexpr double kLiveFrameTime = 0.02;
/// Further behind than this, the simulation goes on from now instead of being hurried, s.
constexpr Seconds kMostBehind(0.1);

std::shared_ptr<const std::string> text_of(const nlohmann::ordered_json& json) {
  // Names from files may hold bytes that are no UTF-8.
  return std::make_shared<const std::string>(
      json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace

LiveView::LiveView(std::unique_ptr<ViewSession> session) : session_(std::move(session)) {
  publish(0);
  thread_ = std::thread([this] { run(); });
}

LiveView::~LiveView() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  news_.notify_all();
  thread_.join();
}

void LiveView::run() {
  try {
    simulate();
    give_up("it was ended");
  } catch (const std::exception& problem) {
    give_up(problem.what());
  }
}

void LiveView::simulate() {
  Clock::time_point due = Clock::now(), before = due;
  double left = 0;  // control steps that the pace has not made whole yet
  double rate = 1;  // simulated over passed time, smoothed over half a second
  for (;;) {
    // Another subject may have another one.
    const double control_dt = session_->control_dt();
    const int steps = std::max(1, static_cast<int>(std::lround(kLiveFrameTime / control_dt)));
    due += std::chrono::duration_cast<Clock::duration>(Seconds(steps * control_dt));
    {
      std::unique_lock lock(mutex_);
      news_.wait_until(lock, due, [this] { return ending_; });
      if (ending_) return;
    }
    obey();
    left += session_->pace() * steps;
    const int whole = static_cast<int>(left);
    left -= whole;
    session_->advance(whole);
    const Clock::time_point now = Clock::now();
    const double passed = Seconds(now - before).count();
    before = now;
    const double share = std::min(1.0, passed / 0.5);
    rate += share * ((session_->paused() ? 0 : whole * session_->control_dt() / passed) - rate);
    publish(rate);
    if (now - due > kMostBehind) due = now;
  }
}

void LiveView::obey() {
  std::deque<Order> orders;
  {
    const std::scoped_lock lock(mutex_);
    orders.swap(orders_);
  }
  for (Order& order : orders) {
    try {
      session_->apply(order.command);
      order.done.set_value();
    } catch (const ConfigError&) {
      order.done.set_exception(std::current_exception());
    }
  }
}

void LiveView::publish(double rate) {
  nlohmann::ordered_json json = session_->frame();
  json["rate"] = std::round(rate * 100) / 100;
  std::shared_ptr<const std::string> options, scene;
  if (session_->subject_revision() != shown_subject_) options = text_of(session_->options());
  if (session_->scene_revision() != shown_scene_) scene = text_of(session_->scene());
  shown_subject_ = session_->subject_revision();
  shown_scene_ = session_->scene_revision();
  std::shared_ptr<const ReportPage> recording = session_->recording();
  {
    const std::scoped_lock lock(mutex_);
    json["number"] = frame_.number + 1;
    frame_ = {frame_.number + 1, text_of(json)};
    if (options) options_ = std::move(options);
    if (scene) scene_ = std::move(scene);
    recording_.swap(recording);
  }
  news_.notify_all();
}

void LiveView::give_up(const std::string& why) {
  std::deque<Order> orders;
  {
    const std::scoped_lock lock(mutex_);
    failure_ = why;
    orders.swap(orders_);
  }
  for (Order& order : orders)
    order.done.set_exception(
        std::make_exception_ptr(ConfigError("view", "simulation", "one that runs", why)));
  news_.notify_all();
}

void LiveView::execute(const ViewCommand& command) {
  std::future<void> done;
  {
    const std::scoped_lock lock(mutex_);
    if (!failure_.empty()) throw ConfigError("view", "simulation", "one that runs", failure_);
    if (orders_.size() == kMaxOrders)
      throw ConfigError("view", "commands", fmt::format("at most {} that wait", kMaxOrders), "more");
    orders_.push_back({command, {}});
    done = orders_.back().done.get_future();
  }
  done.get();
}

LiveFrame LiveView::next_frame(std::uint64_t seen, std::chrono::milliseconds patience) const {
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, patience, [&] { return frame_.number != seen || ending_ || !failure_.empty(); });
  return frame_;
}

std::shared_ptr<const std::string> LiveView::options() const {
  const std::scoped_lock lock(mutex_);
  return options_;
}

std::shared_ptr<const std::string> LiveView::scene() const {
  const std::scoped_lock lock(mutex_);
  return scene_;
}

std::shared_ptr<const ReportPage> LiveView::recording() const {
  const std::scoped_lock lock(mutex_);
  return recording_;
}

std::string LiveView::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

}  // namespace crossgait
