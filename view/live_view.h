// A session at the pace of the clock on the wall, in a thread of its own, watched by any number of others.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "view/session.h"

namespace crossgait {

/// Holds a frame as text, the same for all that watch.
struct LiveFrame {
  std::uint64_t number = 0;  ///< from 1
  std::shared_ptr<const std::string> json;
};

/// Simulates by the clock: whole control steps, twenty milliseconds of them at a time, then a frame. Where
/// the machine is too slow the simulation falls behind and is not hurried after. The physics never sees the
/// clock. Only the newest frame is kept: who does not come for it in time misses it.
class LiveView {
 public:
  /// Starts the thread. @param session  is its own from now on
  explicit LiveView(std::unique_ptr<ViewSession> session);
  /// Ends the thread.
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// Executes a command before the next step, after those that wait already. Called from any thread; returns
  /// when it is done.
  /// @throws ConfigError as ViewSession::apply, or if too many wait
  void execute(const ViewCommand& command);
  /// Returns the newest frame, as soon as it is not number `seen`; the same again after `patience`.
  LiveFrame next_frame(std::uint64_t seen, std::chrono::milliseconds patience) const;
  /// Returns ViewSession::options and ViewSession::scene as text.
  std::shared_ptr<const std::string> options() const;
  std::shared_ptr<const std::string> scene() const;
  /// Returns ViewSession::recording.
  std::shared_ptr<const ReportPage> recording() const;
  /// Says why the simulation ended, empty while it goes on.
  std::string failure() const;

 private:
  struct Order {
    ViewCommand command;
    std::promise<void> done;
  };
  void run();
  void simulate();
  void obey();
  void publish(double rate);
  void give_up(const std::string& why);

  std::unique_ptr<ViewSession> session_;  // of the thread, once it runs
  int shown_subject_ = 0, shown_scene_ = 0;

  mutable std::mutex mutex_;
  mutable std::condition_variable news_;
  std::deque<Order> orders_;
  LiveFrame frame_;
  std::shared_ptr<const std::string> options_, scene_;
  std::shared_ptr<const ReportPage> recording_;
  std::string failure_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace crossgait
