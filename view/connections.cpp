#include "view/connections.h"

#include <algorithm>
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

/// One connection, whose head was read: the rest is read until a moment that is the same for all of it, and
/// written as long as the client takes anything.
class TimedStream : public httplib::Stream {
 public:
  TimedStream(ArrivedRequest request, std::chrono::milliseconds write)
      : request_(std::move(request)), write_(write), end_(request_.bytes.size()) {}

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
    std::memcpy(to, request_.bytes.data() + begin_, count);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }

  ssize_t write(const char* from, std::size_t size) override {
    if (!wait(POLLOUT, write_)) return -1;
    ssize_t count = 0;
    do {
      count = ::send(request_.socket, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    } while (count < 0 && errno == EINTR);
    return count;
  }

  // Nobody asks: every client is on this machine.
  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return request_.socket; }

 private:
  std::chrono::milliseconds time_left() const {
    return std::max(std::chrono::milliseconds(0),
                    std::chrono::duration_cast<std::chrono::milliseconds>(request_.until - Clock::now()));
  }
  bool wait(short what, std::chrono::milliseconds time) const {
    pollfd socket{request_.socket, what, 0};
    int ready = 0;
    do {
      ready = ::poll(&socket, 1, static_cast<int>(time.count()));
    } while (ready < 0 && errno == EINTR);
    return ready > 0;
  }
  bool is_open() const {
    char next = 0;
    const ssize_t count = ::recv(request_.socket, &next, 1, MSG_PEEK | MSG_DONTWAIT);
    return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
  }
  ssize_t receive() {
    request_.bytes.resize(kPiece);
    ssize_t count = 0;
    do {
      count = ::recv(request_.socket, request_.bytes.data(), kPiece, MSG_DONTWAIT);
    } while (count < 0 && errno == EINTR);
    return count;
  }

  static constexpr std::size_t kPiece = 4096;
  ArrivedRequest request_;  // its bytes are received into anew, once they are read
  std::chrono::milliseconds write_;
  std::size_t begin_ = 0, end_;  // of what was received and not yet read
};

}  // namespace

/// Threads that answer.
class BoundedServer::Answers {
 public:
  Answers(BoundedServer& server, const ConnectionLimits& limits) : server_(server), most_(limits.waiting) {
    try {
      for (std::size_t i = 0; i < limits.threads; ++i) threads_.emplace_back([this] { serve(); });
    } catch (const std::system_error&) {
      end();  // those that did start
      throw;
    }
  }
  ~Answers() { end(); }
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;
  Answers(Answers&&) = delete;
  Answers& operator=(Answers&&) = delete;

  void add(ArrivedRequest request) {
    {
      const std::scoped_lock lock(mutex_);
      waiting_.push_back(std::move(request));
      if (waiting_.size() > most_) {
        ::close(waiting_.front().socket);
        waiting_.pop_front();
      }
    }
    changed_.notify_one();
  }

  void end() {
    {
      const std::scoped_lock lock(mutex_);
      ended_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
    for (const ArrivedRequest& request : waiting_) ::close(request.socket);
    waiting_.clear();
  }

 private:
  void serve() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return ended_ || !waiting_.empty(); });
      if (ended_) return;
      ArrivedRequest request = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      server_.answer(std::move(request));
      lock.lock();
    }
  }

  BoundedServer& server_;
  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ArrivedRequest> waiting_;
  bool ended_ = false;
  std::vector<std::thread> threads_;
};

namespace {

/// The library's queue of connections: what it accepts waits elsewhere, with `process_and_close_socket`.
class NoQueue : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> take_over) override { take_over(); }
  void shutdown() override {}
};

}  // namespace

BoundedServer::BoundedServer(const ConnectionLimits& limits)
    : limits_(limits),
      answers_(std::make_unique<Answers>(*this, limits)),
      heads_(limits.head, [this](ArrivedRequest request) { answers_->add(std::move(request)); }) {
  new_task_queue = [] { return std::make_unique<NoQueue>().release(); };  // the library deletes it
}

BoundedServer::~BoundedServer() { end(); }

void BoundedServer::widen_backlog() {
  static_cast<void>(::listen(svr_sock_, static_cast<int>(limits_.head.waiting)));
}

void BoundedServer::end() {
  stop();
  heads_.end();
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
    // Whoever reads or writes there is woken; closing is for the thread that has it.
    for (const socket_t socket : open_) ::shutdown(socket, SHUT_RDWR);
  }
  answers_->end();
}

bool BoundedServer::begin(socket_t socket) {
  const std::scoped_lock lock(mutex_);
  if (ended_) return false;
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
  heads_.add(socket);
  return true;
}

void BoundedServer::answer(ArrivedRequest request) {
  const socket_t socket = request.socket;
  if (begin(socket)) {
    TimedStream stream(std::move(request), limits_.write);
    bool is_closed = false;
    // Ranges overlap as often as a client likes, and would be put together in memory.
    process_request(stream, true, is_closed, [](httplib::Request& asked) { asked.ranges.clear(); });
  }
  finish(socket);
}

}  // namespace crossgait
