#include "view/server.h"

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <httplib.h>

#include "physics/core/error.h"
#include "view/connections.h"
#include "view/dropped_files.h"
#include "view/request_check.h"

namespace crossgait {
namespace {

using namespace std::chrono_literals;
using Handled = httplib::Server::HandlerResponse;

/// How long a stream without news says nothing: then a comment, so that the end of a connection is noticed.
constexpr auto kPatience = 500ms;
/// Threads for requests that are no streams.
constexpr std::size_t kShortRequests = 8;

void answer(httplib::Response& response, int status, const std::string& text) {
  response.status = status;
  response.set_content(text + "\n", "text/plain; charset=utf-8");
}

/// One place of those for streams; given back when the stream ends, however it does.
class ViewerPlace {
 public:
  static std::shared_ptr<ViewerPlace> take(std::atomic<int>& taken, std::size_t places) {
    auto place = std::make_shared<ViewerPlace>(taken);
    return static_cast<std::size_t>(taken.load()) <= places ? place : nullptr;
  }
  explicit ViewerPlace(std::atomic<int>& taken) : taken_(taken) { ++taken_; }
  ~ViewerPlace() { --taken_; }
  ViewerPlace(const ViewerPlace&) = delete;
  ViewerPlace& operator=(const ViewerPlace&) = delete;

 private:
  std::atomic<int>& taken_;
};

// Ports are one program's: without SO_REUSEPORT, which the library would set.
void prepare_socket(socket_t socket) {
  // Little is kept for a slow client: what it gets is to be fresh.
  const int yes = 1, kept = 64 * 1024;
  static_cast<void>(::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes));
  static_cast<void>(
      ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kept, sizeof kept));  // taken over by connections
}

}  // namespace

void require_view_server() {}

class ViewServer::Implementation {
 public:
  Implementation(LiveView& view, const ViewServerOptions& options)
      : view_(view), options_(options), server_({.head = {}, .threads = options.viewers + kShortRequests}) {
    configure();
    route();
    constexpr const char* kLoopback = "127.0.0.1";
    port_ = options.port;
    if (port_ == 0) {
      port_ = server_.bind_to_any_port(kLoopback);
    } else if (!server_.bind_to_port(kLoopback, port_)) {
      port_ = -1;
    }
    if (port_ <= 0) throw ConfigError("view", "port", "a port that is free", fmt::format("{}", options.port));
    server_.widen_backlog();
    thread_ = std::thread([this] {
      server_.listen_after_bind();
      listened_ = true;
    });
    // Only a server that runs can be stopped.
    while (!server_.is_running() && !listened_) std::this_thread::sleep_for(1ms);
  }
  ~Implementation() {
    ending_ = true;
    server_.end();
    thread_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  int port() const noexcept { return port_; }
  std::string address() const { return fmt::format("http://127.0.0.1:{}/{}/", port_, options_.token); }

 private:
  void configure() {
    server_.set_socket_options(prepare_socket);
    server_.set_tcp_nodelay(true);
    server_.set_payload_max_length(kMostDroppedBytes);
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"Content-Security-Policy", "frame-ancestors 'none'"},
                                 {"Cross-Origin-Resource-Policy", "same-origin"},
                                 {"Referrer-Policy", "no-referrer"},
                                 {"X-Content-Type-Options", "nosniff"}});
    server_.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      return admit(request, response) ? Handled::Unhandled : Handled::Handled;
    });
    server_.set_exception_handler(
        [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
          answer(response, 500, "the request failed");
        });
  }

  bool admit(const httplib::Request& request, httplib::Response& response) const {
    RequestFacts facts{request.path, request.get_header_value("Host"), {}};
    if (request.get_header_value_count("Host") > 1) facts.host.clear();
    if (request.has_header("Origin")) facts.origin = request.get_header_value("Origin");
    if (request.get_header_value_count("Origin") > 1) facts.origin.emplace();
    if (!admitted_path(facts, options_.token, port_)) {
      answer(response, 403, "not allowed: the address that `crossgait view` printed is needed, as it is");
    } else if (request.method != "GET" && request.method != "POST") {
      answer(response, 405, "GET and POST alone");
    } else if (request.method == "POST") {
      return facts.path.ends_with("/drop")
                 ? admit_body(request, response, "multipart/form-data", kMostDroppedBytes)
                 : admit_body(request, response, "application/json", kMaxCommandBytes);
    } else {
      return true;
    }
    return false;
  }

  // Only what has a length that is known and checked is read.
  static bool admit_body(const httplib::Request& request, httplib::Response& response, std::string_view type,
                         std::size_t most) {
    const std::string said = request.get_header_value("Content-Type");
    if (request.has_header("Transfer-Encoding") || !request.has_header("Content-Length")) {
      answer(response, 411, "a body with its length is needed");
    } else if (said.substr(0, said.find(';')) != type || request.has_header("Content-Encoding")) {
      answer(response, 415, fmt::format("{} is needed", type));
    } else if (request.get_header_value<std::uint64_t>("Content-Length") > most) {
      answer(response, 413, fmt::format("at most {} bytes", most));
    } else {
      return true;
    }
    return false;
  }

  void route() {
    const std::string at = "/" + options_.token;
    const auto json = [this, at](const char* path, auto text) {
      server_.Get(at + path, [text](const httplib::Request&, httplib::Response& response) {
        response.set_content(*text(), "application/json");
      });
    };
    json("/options", [this] { return view_.options(); });
    json("/scene", [this] { return view_.scene(); });
    server_.Get(at + "/", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(options_.page, "text/html; charset=utf-8");
    });
    server_.Get(at + "/frames",
                [this](const httplib::Request&, httplib::Response& response) { stream(response); });
    server_.Get(at + "/report",
                [this](const httplib::Request&, httplib::Response& response) { report(response); });
    server_.Post(at + "/command", [this](const httplib::Request& request, httplib::Response& response) {
      execute(response, [&] { return parse_view_command(request.body); });
    });
    server_.Post(at + "/drop", [this](const httplib::Request&, httplib::Response& response,
                                      const httplib::ContentReader& read) { drop(response, read); });
  }

  // Of a second one nothing is kept: together they would take as many times the memory. It is read all the
  // same, or its sender would not come to read the answer.
  void drop(httplib::Response& response, const httplib::ContentReader& read) {
    const std::unique_lock one(drop_, std::try_to_lock);
    if (!one) {
      read([](const httplib::MultipartFormData&) { return true; },
           [](const char*, std::size_t) { return true; });
      return answer(response, 503, "other files are being dropped: again, once those are there");
    }
    std::vector<std::pair<std::string, std::string>> parts;  // paths and bytes
    const auto are_too_many = [&parts] { return parts.size() > kMostDroppedFiles; };
    const bool are_whole = read(
        [&](const httplib::MultipartFormData& part) {
          if (!are_too_many()) parts.emplace_back(part.name, std::string());
          return true;
        },
        [&](const char* bytes, std::size_t size) {
          if (!are_too_many()) parts.back().second.append(bytes, size);
          return true;
        });
    if (!are_whole) return answer(response, 400, "parts as multipart/form-data has them are needed");
    std::vector<DroppedFile> files;
    for (const auto& [path, bytes] : parts) files.push_back({path, bytes});
    execute(response, [&] { return SubjectCommand{keep_dropped(files)}; });
  }

  template <typename Read>
  void execute(httplib::Response& response, const Read& read) {
    try {
      view_.execute(read());
      response.status = 204;
    } catch (const ConfigError& error) {
      answer(response, 400, error.what());
    }
  }

  void stream(httplib::Response& response) {
    const auto place = ViewerPlace::take(viewers_, options_.viewers);
    if (!place) return answer(response, 503, "as many look on as may");
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, place, seen = std::uint64_t{0}](std::size_t, httplib::DataSink& sink) mutable {
          // Writing waits for a slow client; the frames of that time are not sent later.
          const LiveFrame frame = view_.next_frame(seen, kPatience);
          if (ending_ || !view_.failure().empty()) {
            sink.done();
            return true;
          }
          const std::string text = frame.number == seen ? ":\n\n" : fmt::format("data: {}\n\n", *frame.json);
          seen = frame.number;
          return sink.write(text.data(), text.size());
        });
  }

  void report(httplib::Response& response) const {
    const std::shared_ptr<const ReportPage> page = view_.recording();
    if (!page) return answer(response, 404, "nothing has been recorded");
    response.set_header("Content-Disposition", "attachment; filename=\"crossgait-live.html\"");
    response.set_content(report_html(*page), "text/html; charset=utf-8");
  }

  LiveView& view_;
  const ViewServerOptions options_;
  BoundedServer server_;  // one request per connection: what is refused unread is not taken for the next one
  int port_ = 0;
  std::atomic<int> viewers_{0};
  std::atomic<bool> ending_{false}, listened_{false};
  std::mutex drop_;  ///< held by who is reading dropped files
  std::thread thread_;
};

ViewServer::ViewServer(LiveView& view, const ViewServerOptions& options)
    : own_(std::make_unique<Implementation>(view, options)) {}
ViewServer::~ViewServer() = default;
int ViewServer::port() const noexcept { return own_->port(); }
std::string ViewServer::address() const { return own_->address(); }

}  // namespace crossgait
