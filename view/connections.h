// Connections to the view's server: how long they may take, how many may wait, and how all of them end.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <set>

#include <httplib.h>

namespace crossgait {

struct ConnectionLimits {
  std::chrono::milliseconds request{2000};  ///< for a request's head and body together
  std::chrono::milliseconds write{2000};    ///< that a client takes nothing for
  std::size_t threads = 1;
  std::size_t waiting = 64;  ///< connections that no thread has taken up
};

/// Answers one request per connection, as a server that nobody holds up: whoever has not sent a whole request
/// in time is let go, however much of it came; of those that wait the newest is next, and the oldest is let
/// go where they are too many. `Range` is not looked at: everything is sent whole.
class BoundedServer : public httplib::Server {
 public:
  /// @throws std::system_error if its threads cannot be started
  explicit BoundedServer(const ConnectionLimits& limits);
  ~BoundedServer() override;
  BoundedServer(const BoundedServer&) = delete;
  BoundedServer& operator=(const BoundedServer&) = delete;
  BoundedServer(BoundedServer&&) = delete;
  BoundedServer& operator=(BoundedServer&&) = delete;

  /// Ends every connection at once, and accepts no more. From any thread, once the server runs.
  void end();

 private:
  class Queue;
  bool process_and_close_socket(socket_t socket) override;
  bool begin(socket_t socket);
  void finish(socket_t socket);

  const ConnectionLimits limits_;
  std::unique_ptr<Queue> queue_;  ///< until the server listens
  std::mutex mutex_;
  std::set<socket_t> open_;  ///< that a thread reads or writes
  bool ended_ = false;
};

}  // namespace crossgait
