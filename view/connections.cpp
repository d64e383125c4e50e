#include "view/connections.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <functional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace crossgait {
namespace {

using Clock = std::chrono::steady_clock;

/// Whether this thread is letting a connection go that it was to answer.
thread_local bool lets_go = false;

/// One connection: read until a moment that is the same for all that comes, and written as long as the client
/// takes anything.
class TimedStream : public httplib::Stream {
 public:
  TimedStream(socket_t socket, const ConnectionLimits& limits)
      : socket_(socket), until_(Clock::now() + limits.request), write_(limits.write) {}

  bool is_readable() const override { return begin_ < end_ || wait(POLLIN, time_left()); }
  bool is_writable() const override { return wait(POLLOUT, write_) && is_open(); }

  ssize_t read(char* to, std::size_t size) override {
    // Heads are read byte by byte.
    if (begin_ == end_) {
      if (!wait(POLLIN, time_left())) return -1;
      const ssize_t count = receive();
      if (count <= 0) return count;
      begin_ = 0;
      end_ = static_cast<std::size_t>(count);
    }
    const std::size_t count = std::min(size, end_ - begin_);
    std::memcpy(to, buffer_.data() + begin_, count);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }

  ssize_t write(const char* from, std::size_t size) override {
    if (!wait(POLLOUT, write_)) return -1;
    ssize_t count = 0;
    do {
      count = ::send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    } while (count < 0 && errno == EINTR);
    return count;
  }

  // Nobody asks: every client is on this machine.
  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return socket_; }

 private:
  std::chrono::milliseconds time_left() const {
    return std::max(std::chrono::milliseconds(0),
                    std::chrono::duration_cast<std::chrono::milliseconds>(until_ - Clock::now()));
  }
  bool wait(short what, std::chrono::milliseconds time) const {
    pollfd socket{socket_, what, 0};
    int ready = 0;
    do {
      ready = ::poll(&socket, 1, static_cast<int>(time.count()));
    } while (ready < 0 && errno == EINTR);
    return ready > 0;
  }
  bool is_open() const {
    char next = 0;
    const ssize_t count = ::recv(socket_, &next, 1, MSG_PEEK | MSG_DONTWAIT);
    return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
  }
  ssize_t receive() {
    ssize_t count = 0;
    do {
      count = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    } while (count < 0 && errno == EINTR);
    return count;
  }

  socket_t socket_;
  Clock::time_point until_;
  std::chrono::milliseconds write_;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;  // of what was received and not yet read
};

}  // namespace

/// Threads that answer, the newest connection first: of many that say nothing, none is in the way of the next
/// that does.
class BoundedServer::Queue : public httplib::TaskQueue {
 public:
  explicit Queue(const ConnectionLimits& limits) : most_(limits.waiting) {
    try {
      for (std::size_t i = 0; i < limits.threads; ++i) threads_.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
      shutdown();  // those that did start
      throw;
    }
  }

  void enqueue(std::function<void()> answer) override {
    std::function<void()> oldest;
    {
      const std::scoped_lock lock(mutex_);
      waiting_.push_back(std::move(answer));
      if (waiting_.size() > most_) {
        oldest = std::move(waiting_.front());
        waiting_.pop_front();
      }
    }
    if (oldest) let_go(oldest);
    changed_.notify_one();
  }

  void shutdown() override {
    {
      const std::scoped_lock lock(mutex_);
      ended_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    for (const std::function<void()>& answer : waiting_) let_go(answer);
    waiting_.clear();
  }

 private:
  static void let_go(const std::function<void()>& answer) {
    lets_go = true;
    answer();
    lets_go = false;
  }
  void serve() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return ended_ || !waiting_.empty(); });
      if (ended_) return;
      const std::function<void()> answer = std::move(waiting_.back());
      waiting_.pop_back();
      lock.unlock();
      answer();
      lock.lock();
    }
  }

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool ended_ = false;
  std::vector<std::thread> threads_;
};

BoundedServer::BoundedServer(const ConnectionLimits& limits)
    : limits_(limits), queue_(std::make_unique<Queue>(limits)) {
  new_task_queue = [this] { return queue_.release(); };  // the library's, which deletes it
}

BoundedServer::~BoundedServer() {
  if (queue_) queue_->shutdown();
}

void BoundedServer::end() {
  stop();
  const std::scoped_lock lock(mutex_);
  ended_ = true;
  // Whoever reads or writes there is woken; closing is for the thread that has it.
  for (const socket_t socket : open_) ::shutdown(socket, SHUT_RDWR);
}

bool BoundedServer::begin(socket_t socket) {
  const std::scoped_lock lock(mutex_);
  if (ended_ || lets_go) return false;
  open_.insert(socket);
  return true;
}

void BoundedServer::finish(socket_t socket) {
  {
    const std::scoped_lock lock(mutex_);
    open_.erase(socket);
  }
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
}

bool BoundedServer::process_and_close_socket(socket_t socket) {
  bool is_answered = false;
  if (begin(socket)) {
    TimedStream stream(socket, limits_);
    bool is_closed = false;
    // Ranges overlap as often as a client likes, and would be put together in memory.
    is_answered =
        process_request(stream, true, is_closed, [](httplib::Request& request) { request.ranges.clear(); });
  }
  finish(socket);
  return is_answered;
}

}  // namespace crossgait
