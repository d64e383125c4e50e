// Connections whose request has not come yet: one thread reads the heads of all of them, so that whoever says
// nothing, or little by little, holds no thread that answers.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace crossgait {

struct HeadLimits {
  std::chrono::milliseconds request{2000};  ///< for a request's head and body together
  std::size_t most_bytes = 32 * 1024;       ///< of a head
  std::size_t waiting = 64;  ///< connections whose head is not whole: of more, the oldest is closed
};

/// Holds a connection whose request's head has come; whoever gets it closes it.
struct ArrivedRequest {
  int socket = -1;
  std::string bytes;                            ///< what was read: the head, and what came with it
  std::chrono::steady_clock::time_point until;  ///< for what is left of it: now, of a head that is too long
};

/// Reads heads ("…\r\n\r\n") of requests.
class RequestHeads {
 public:
  /// Calls `arrived` from its own thread. @throws std::system_error if that, or its event, cannot be made
  RequestHeads(const HeadLimits& limits, std::function<void(ArrivedRequest)> arrived);
  ~RequestHeads();
  RequestHeads(const RequestHeads&) = delete;
  RequestHeads& operator=(const RequestHeads&) = delete;
  RequestHeads(RequestHeads&&) = delete;
  RequestHeads& operator=(RequestHeads&&) = delete;

  /// Takes over a connection. From any thread.
  void add(int socket);
  /// Closes all that are held, and whatever is added from now on. From any thread but its own.
  void end();

 private:
  void run();
  /// Takes what was added; false once it has ended.
  bool take_added();
  void wait_for_bytes();
  /// Takes what came. @returns whether more is waited for
  bool read(ArrivedRequest& waiting);
  void let_the_oldest_go();
  void wake() const;

  const HeadLimits limits_;
  const std::function<void(ArrivedRequest)> arrived_;
  std::vector<ArrivedRequest> waiting_;  ///< oldest first
  const int event_;
  std::mutex mutex_;
  std::vector<ArrivedRequest> added_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace crossgait
