// The view's server: the page, the session's documents, frames as server-sent events, commands by POST. On
// the loopback interface alone.
#pragma once

#include <memory>
#include <string>

#include "view/live_view.h"

namespace crossgait {

/// Checks that Crossgait was built with a server (cpp-httplib). @throws ConfigError from
/// `require_view_server` if not
void require_view_server();

struct ViewServerOptions {
  int port = 0;             ///< 0: any that is free
  std::string page;         ///< what GET / answers
  std::string token;        ///< in the address, before everything else
  std::size_t viewers = 8;  ///< streams of frames at once; more are told to wait (503)
};

/// Answers below http://127.0.0.1:PORT/TOKEN: GET `/` (the page), `/options`, `/scene` (JSON), `/frames`
/// (server-sent events, one frame each), `/report` (the last recording as a page, 404 if there is none), and
/// POST `/command` (JSON as command.h has it; 204, or 400 with the reason) and `/drop` (multipart/form-data,
/// a part for each file, named by its path: what is driven from then on; the same answers). 403: wrong token,
/// a host that is not ours, a page of another origin; 413: a body of more than kMaxCommandBytes or
/// kMostDroppedBytes; 415: of another type; 503: as many look on as may, or other files are being dropped.
/// Who reads slowly gets fewer frames.
class ViewServer {
 public:
  /// Listens and answers, in threads of its own. @param view  outlives it
  /// @throws ConfigError if the port is taken, or without a server
  ViewServer(LiveView& view, const ViewServerOptions& options);
  /// Ends every stream and thread.
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  int port() const noexcept;
  /// Returns the address with the token: who knows it may drive.
  std::string address() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> own_;
};

}  // namespace crossgait
