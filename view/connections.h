// Connections to the view's server: how long they may take, how many may wait, and how all of them end.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <set>

#include <httplib.h>

#include "view/request_heads.h"

namespace crossgait {

struct ConnectionLimits {
  HeadLimits head;
  std::chrono::milliseconds write{2000};  ///< that a client takes nothing for
  std::size_t threads = 1;
  std::size_t waiting = 64;  ///< requests that no thread has taken up: of more, the oldest is let go
};

/// Answers one request per connection, as a server that nobody holds up: a thread takes up a connection once
/// its request's head is there, and lets it go where the body does not come in time, however much of it came.
/// `Range` is not looked at: everything is sent whole.
class BoundedServer : public httplib::Server {
 public:
  /// @throws std::system_error if its threads cannot be started
  explicit BoundedServer(const ConnectionLimits& limits);
  ~BoundedServer() override;
  BoundedServer(const BoundedServer&) = delete;
  BoundedServer& operator=(const BoundedServer&) = delete;
  BoundedServer(BoundedServer&&) = delete;
  BoundedServer& operator=(BoundedServer&&) = delete;

  /// Lets as many connections arrive at once as may wait: the library's own five would have the sixth try
  /// again a second later. Once the server is bound.
  void widen_backlog();

  /// Ends every connection at once, accepts no more, and waits for the threads that answer. From any other
  /// thread, once the server runs.
  void end();

 private:
  class Answers;
  bool process_and_close_socket(socket_t socket) override;
  void answer(ArrivedRequest request);
  bool begin(socket_t socket);
  void finish(socket_t socket);

  const ConnectionLimits limits_;
  std::mutex mutex_;
  std::set<socket_t> open_;  ///< that a thread reads or writes
  bool ended_ = false;
  std::unique_ptr<Answers> answers_;
  RequestHeads heads_;
};

}  // namespace crossgait
