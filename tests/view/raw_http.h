// HTTP as bytes on a socket: requests that no well-behaved client would send.
#pragma once

#include <string>

namespace crossgait {

/// Connects to 127.0.0.1. Reading gives up after a minute without a byte.
class RawConnection {
 public:
  /// @param receive_bytes  of the system's buffer for what is not read; 0: its own choice
  explicit RawConnection(int port, int receive_bytes = 0);
  ~RawConnection();
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  void send(const std::string& text) const;
  /// Reads all up to the end of the connection.
  std::string read_all() const;
  /// Reads at least up to where `text` has come `times` times, or the end.
  std::string read_until(const std::string& text, int times) const;
  /// Reads what is left; whether the server ended the connection, rather than left it open for a minute.
  bool ends() const;

 private:
  bool read_some(std::string& to) const;
  int socket_;
};

/// Holds what a server answers.
struct RawAnswer {
  int status = 0;
  std::string head, body;
};

/// Sends the request as it is and reads until the server ends the connection.
RawAnswer ask(int port, const std::string& request);

/// Writes a GET or POST with these lines of headers beside Host and, of a body, its type and length.
std::string request_text(const std::string& method, const std::string& path, int port,
                         const std::string& body = {}, const std::string& headers = {});

}  // namespace crossgait
