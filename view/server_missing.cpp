// In the place of server.cpp where cpp-httplib was not found.
#include "physics/core/error.h"
#include "view/server.h"

namespace crossgait {

class ViewServer::Implementation {};

void require_view_server() {
  throw ConfigError("view", "server", "a Crossgait that was built with cpp-httplib (libcpp-httplib-dev)",
                    "one without");
}

ViewServer::ViewServer(LiveView&, const ViewServerOptions&) { require_view_server(); }
ViewServer::~ViewServer() = default;
int ViewServer::port() const noexcept { return 0; }
std::string ViewServer::address() const { return {}; }

}  // namespace crossgait
