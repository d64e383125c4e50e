#include "view/request_heads.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace crossgait {
namespace {

using Clock = std::chrono::steady_clock;

int make_event() {
  const int event = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (event < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  return event;
}

}  // namespace

RequestHeads::RequestHeads(const HeadLimits& limits, std::function<void(ArrivedRequest)> arrived)
    : limits_(limits), arrived_(std::move(arrived)), event_(make_event()) {
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error&) {
    ::close(event_);
    throw;
  }
}

RequestHeads::~RequestHeads() {
  end();
  ::close(event_);
}

void RequestHeads::add(int socket) {
  {
    const std::scoped_lock lock(mutex_);
    if (ended_) {
      ::close(socket);
      return;
    }
    added_.push_back({socket, {}, Clock::now() + limits_.request});
  }
  wake();
}

void RequestHeads::end() {
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  wake();
  if (thread_.joinable()) thread_.join();
}

void RequestHeads::wake() const { static_cast<void>(::eventfd_write(event_, 1)); }

void RequestHeads::run() {
  while (take_added()) {
    wait_for_bytes();
    std::erase_if(waiting_, [this](ArrivedRequest& each) { return !read(each); });
    let_the_oldest_go();  // only now: what has come is not lost to those that came after it
  }
  for (const ArrivedRequest& each : waiting_) ::close(each.socket);
  waiting_.clear();
}

bool RequestHeads::take_added() {
  const std::scoped_lock lock(mutex_);
  std::move(added_.begin(), added_.end(), std::back_inserter(waiting_));
  added_.clear();
  return !ended_;
}

void RequestHeads::wait_for_bytes() {
  std::vector<pollfd> polled{{event_, POLLIN, 0}};
  for (const ArrivedRequest& each : waiting_) polled.push_back({each.socket, POLLIN, 0});
  int milliseconds = -1;
  if (!waiting_.empty()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(waiting_.front().until - Clock::now());
    milliseconds = static_cast<int>(std::max<std::int64_t>(0, left.count()));
  }
  static_cast<void>(::poll(polled.data(), polled.size(), milliseconds));
  std::uint64_t count = 0;
  static_cast<void>(::eventfd_read(event_, &count));
}

bool RequestHeads::read(ArrivedRequest& waiting) {
  constexpr std::string_view kEnd = "\r\n\r\n";
  std::array<char, 4096> buffer{};
  ssize_t count = 0;
  do {
    count = ::recv(waiting.socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
  } while (count < 0 && errno == EINTR);
  const bool has_said_nothing = count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  if (count > 0) {
    std::string& bytes = waiting.bytes;
    const std::size_t from = bytes.size() - std::min(bytes.size(), kEnd.size() - 1);
    bytes.append(buffer.data(), static_cast<std::size_t>(count));
    const bool is_whole = bytes.find(kEnd, from) != std::string::npos;
    if (is_whole || bytes.size() > limits_.most_bytes) {
      if (!is_whole) waiting.until = Clock::now();
      arrived_(std::move(waiting));
      return false;
    }
  }
  if ((count > 0 || has_said_nothing) && Clock::now() < waiting.until) return true;
  ::close(waiting.socket);
  return false;
}

void RequestHeads::let_the_oldest_go() {
  if (waiting_.size() <= limits_.waiting) return;
  const auto end = waiting_.end() - static_cast<std::ptrdiff_t>(limits_.waiting);
  for (auto each = waiting_.begin(); each != end; ++each) ::close(each->socket);
  waiting_.erase(waiting_.begin(), end);
}

}  // namespace crossgait
