#include "tests/view/raw_http.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

namespace crossgait {

RawConnection::RawConnection(int port, int receive_bytes) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  if (receive_bytes > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
  const timeval patience{60, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    throw std::runtime_error(std::string("connect: ") + std::strerror(errno));
  }
}

RawConnection::~RawConnection() { ::close(socket_); }

void RawConnection::send(const std::string& text) const {
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = ::send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return;  // the server has heard enough
    sent += static_cast<std::size_t>(count);
  }
}

bool RawConnection::read_some(std::string& to) const {
  std::array<char, 4096> buffer{};
  const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
  if (count <= 0) return false;
  to.append(buffer.data(), static_cast<std::size_t>(count));
  return true;
}

std::string RawConnection::read_all() const {
  std::string text;
  while (read_some(text)) {
  }
  return text;
}

std::string RawConnection::read_until(const std::string& text, int times) const {
  std::string all;
  std::size_t from = 0;
  while (times > 0) {
    if (const std::size_t at = all.find(text, from); at != std::string::npos) {
      from = at + text.size();
      --times;
    } else if (!read_some(all)) {
      break;
    }
  }
  return all;
}

bool RawConnection::ends() const {
  read_all();
  char byte = 0;
  const ssize_t count = ::recv(socket_, &byte, 1, MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
}

RawAnswer ask(int port, const std::string& request) {
  const RawConnection connection(port);
  connection.send(request);
  const std::string text = connection.read_all();
  RawAnswer answer;
  const std::size_t end = text.find("\r\n\r\n");
  if (text.starts_with("HTTP/1.1 ")) answer.status = std::stoi(text.substr(9, 3));
  answer.head = text.substr(0, end);
  if (end != std::string::npos) answer.body = text.substr(end + 4);
  return answer;
}

std::string request_text(const std::string& method, const std::string& path, int port,
                         const std::string& body, const std::string& headers) {
  const std::string of_body =
      body.empty() ? ""
                   : fmt::format("Content-Type: application/json\r\nContent-Length: {}\r\n", body.size());
  return fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}{}\r\n{}", method, path, port, of_body,
                     headers, body);
}

}  // namespace crossgait
