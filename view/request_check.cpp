#include "view/request_check.h"

#include <array>
#include <cerrno>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/random.h>

namespace crossgait {
namespace {

constexpr std::array<std::string_view, 2> kLoopbackNames{"127.0.0.1", "localhost"};

bool same_text(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return difference == 0;
}

bool is_ours(std::string_view text, std::string_view before, int port) {
  for (const std::string_view name : kLoopbackNames) {
    if (text == fmt::format("{}{}:{}", before, name, port)) return true;
  }
  return false;
}

}  // namespace

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  ssize_t got = 0;
  do {
    got = ::getrandom(bytes.data(), bytes.size(), 0);  // whole up to 256 bytes, once it is not interrupted
  } while (got < 0 && errno == EINTR);
  if (got != static_cast<ssize_t>(bytes.size())) throw std::runtime_error("the system has no random numbers");
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

std::optional<std::string> admitted_path(const RequestFacts& request, std::string_view token, int port) {
  if (!is_ours(request.host, "", port)) return std::nullopt;
  if (request.origin && !is_ours(*request.origin, "http://", port)) return std::nullopt;
  const std::string_view path = request.path;
  if (path.empty() || path.front() != '/') return std::nullopt;
  const std::size_t end = path.find('/', 1);
  if (end == std::string_view::npos || !same_text(path.substr(1, end - 1), token)) return std::nullopt;
  return std::string(path.substr(end));
}

}  // namespace crossgait
