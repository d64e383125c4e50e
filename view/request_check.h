// Who may talk to the view's server: what a request has to show, apart from any HTTP library.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace crossgait {

/// Holds headers and path of a request that decide on it.
struct RequestFacts {
  std::string path;                   ///< without query
  std::string host;                   ///< empty if there is no such header
  std::optional<std::string> origin;  ///< of the page that asks, where a browser says so
};

/// Draws 128 random bits as 32 hexadecimal digits. @throws std::runtime_error if the system gives none
std::string random_token();

/// Returns the path behind "/TOKEN" ("/", "/frames"), if the request shows the token and
/// comes to us under a loopback name ("127.0.0.1:PORT", "localhost:PORT"), from our own
/// page or from no page. Empty: it is to be refused. The host is looked at because
/// another name may lead a browser here (DNS rebinding). Tokens are compared in constant
/// time.
std::optional<std::string> admitted_path(const RequestFacts& request, std::string_view token, int port);

}  // namespace crossgait
