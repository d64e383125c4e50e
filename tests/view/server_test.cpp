// Who may ask the server for what, and what it does about clients that are too many, too slow or too large.
#include "view/server.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "physics/core/text.h"
#include "physics/robot_files/data_path.h"
#include "tests/physics/core/config_error.h"
#include "tests/view/raw_http.h"
#include "tests/view/view_setup.h"
#include "view/dropped_files.h"
#include "view/request_check.h"

namespace crossgait {
namespace {

constexpr const char* kDrive = R"({"do": "drive", "vx": 0.1, "vy": 0, "yaw_rate": 0})";
const std::string kToken(32, 'a');

TEST(AdmittedPath, TakesTheTokenTheHostAndNoForeignOrigin) {
  const auto admitted = [](const std::string& path, const std::string& host,
                           const std::optional<std::string>& origin) {
    return admitted_path({path, host, origin}, kToken, 8000);
  };
  const std::string page = "/" + kToken + "/";
  EXPECT_EQ(admitted(page, "127.0.0.1:8000", {}), "/");
  EXPECT_EQ(admitted(page + "frames", "localhost:8000", "http://localhost:8000"), "/frames");
  for (const char* path : {"", "/", "/frames", "//", "/aaaa/frames", "frames"})
    EXPECT_FALSE(admitted(path, "127.0.0.1:8000", {})) << path;
  EXPECT_FALSE(admitted("/" + kToken, "127.0.0.1:8000", {}));
  EXPECT_FALSE(admitted("/" + std::string(32, 'b') + "/", "127.0.0.1:8000", {}));
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:8001", "evil.example:8000", "127.0.0.1:8000.evil.example"})
    EXPECT_FALSE(admitted(page, host, {})) << host;
  for (const char* origin :
       {"", "null", "http://evil.example", "https://127.0.0.1:8000", "http://127.0.0.1:8001"})
    EXPECT_FALSE(admitted(page, "127.0.0.1:8000", origin)) << origin;
}

TEST(RandomToken, IsLongAndNeverTheSame) {
  const std::string a = random_token(), b = random_token();
  EXPECT_EQ(a.size(), 32U);
  EXPECT_EQ(a.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(a, b);
}

bool has_server() {
  try {
    require_view_server();
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

TEST(ViewServerWithoutHttp, SaysWhatIsMissing) {
  if (has_server()) GTEST_SKIP() << "built with a server";
  EXPECT_NE(config_error(require_view_server).expected().find("cpp-httplib"), std::string::npos);
}

class ViewServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_server() || available_engines().empty()) GTEST_SKIP() << "no server, or no engine";
    start(8);
  }
  void start(std::size_t viewers) {
    server_.reset();
    view_ = std::make_unique<LiveView>(make_view_session({available_engines().front()}));
    server_ = std::make_unique<ViewServer>(
        *view_, ViewServerOptions{.page = "<p>page</p>", .token = kToken, .viewers = viewers});
    port_ = server_->port();
  }
  static std::string at(const std::string& path) { return "/" + kToken + path; }
  RawAnswer get(const std::string& path, const std::string& headers = {}) const {
    return ask(port_, request_text("GET", path, port_, "", headers));
  }
  RawAnswer post(const std::string& body, const std::string& headers = {}) const {
    return ask(port_, request_text("POST", at("/command"), port_, body, headers));
  }
  double commanded() const {
    const std::uint64_t now = view_->next_frame(0, std::chrono::seconds(60)).number;
    return nlohmann::json::parse(*view_->next_frame(now, std::chrono::seconds(60)).json)
        .at("command")
        .at("vx");
  }

  std::unique_ptr<LiveView> view_;
  std::unique_ptr<ViewServer> server_;
  int port_ = 0;
};

TEST_F(ViewServerTest, AnswersWhoHasTheAddress) {
  EXPECT_EQ(server_->address(), "http://127.0.0.1:" + std::to_string(port_) + at("/"));
  const RawAnswer page = get(at("/"));
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<p>page</p>");
  for (const char* header : {"no-store", "no-referrer", "nosniff", "frame-ancestors 'none'"})
    EXPECT_NE(page.head.find(header), std::string::npos) << header;
  EXPECT_TRUE(nlohmann::json::parse(get(at("/options")).body).contains("parameters"));
  EXPECT_TRUE(nlohmann::json::parse(get(at("/scene")).body).contains("scene"));
  EXPECT_EQ(get(at("/report")).status, 404) << "nothing has been recorded";
  EXPECT_EQ(get(at("/nothing")).status, 404);
  EXPECT_EQ(post(kDrive, "Origin: http://127.0.0.1:" + std::to_string(port_) + "\r\n").status, 204);
  EXPECT_EQ(commanded(), 0.1);
}

TEST_F(ViewServerTest, RefusesWhoHasNot) {
  const std::string body = std::string("Content-Type: application/json\r\nContent-Length: ") +
                           std::to_string(std::string(kDrive).size()) + "\r\n\r\n" + kDrive;
  for (const char* path : {"/", "/frames", "/options", "/bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb/frames"})
    EXPECT_EQ(get(path).status, 403) << path;
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"}) {
    EXPECT_EQ(get(at("/frames"), std::string("Origin: ") + origin + "\r\n").status, 403) << origin;
    EXPECT_EQ(post(kDrive, std::string("Origin: ") + origin + "\r\n").status, 403) << origin;
  }
  const std::string own = "Origin: http://127.0.0.1:" + std::to_string(port_) + "\r\n";
  EXPECT_EQ(post(kDrive, own + "Origin: http://evil.example\r\n").status, 403) << "two origins";
  for (const std::string host : {"Host: evil.example\r\n", "Host: 127.0.0.1\r\n", ""})
    EXPECT_EQ(ask(port_, "POST " + at("/command") + " HTTP/1.1\r\n" + host + body).status, 403) << host;
  EXPECT_EQ(get(at("/"), "Host: evil.example\r\n").status, 403) << "two hosts";
  EXPECT_EQ(commanded(), 0) << "nobody has driven";
}

TEST_F(ViewServerTest, ReadsOnlySmallCommandsOfKnownLength) {
  EXPECT_EQ(post(std::string(kMaxCommandBytes + 1, ' ')).status, 413);
  EXPECT_EQ(post("{}").status, 400);
  EXPECT_NE(post(R"({"do": "drive", "vx": 99, "vy": 0, "yaw_rate": 0})").body.find("vx"), std::string::npos);
  EXPECT_EQ(post(kDrive, "Content-Encoding: gzip\r\n").status, 415);
  const std::string head =
      "POST " + at("/command") + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n";
  EXPECT_EQ(ask(port_, head + "Content-Type: text/plain\r\nContent-Length: 2\r\n\r\n{}").status, 415);
  EXPECT_EQ(ask(port_, head + "Content-Type: application/json\r\n\r\n").status, 411);
  EXPECT_EQ(ask(port_, head + "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
                              "2\r\n{}\r\n0\r\n\r\n")
                .status,
            411);
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "HEAD"})
    EXPECT_EQ(ask(port_, request_text(method, at("/command"), port_)).status, 405) << method;
  EXPECT_EQ(commanded(), 0);
}

std::string part(const std::string& path, const std::string& bytes) {
  return "--b\r\nContent-Disposition: form-data; name=\"" + path + "\"; filename=\"f\"\r\n\r\n" + bytes +
         "\r\n";
}

TEST_F(ViewServerTest, TakesWhatIsDroppedAndNothingElseThere) {
  server_.reset();
  view_ = std::make_unique<LiveView>(make_open_session({available_engines().front()}));
  server_ = std::make_unique<ViewServer>(*view_, ViewServerOptions{.page = "", .token = kToken});
  port_ = server_->port();
  const auto drop = [this](const std::string& body,
                           const std::string& type = "multipart/form-data; boundary=b",
                           std::optional<std::size_t> length = {}) {
    return ask(port_, "POST " + at("/drop") + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) +
                          "\r\nContent-Type: " + type + "\r\nContent-Length: " +
                          std::to_string(length.value_or(body.size())) + "\r\n\r\n" + body);
  };
  const std::string robot = find_robot("serial_quadruped");
  const std::string folder = std::filesystem::path(robot).parent_path().string() + "/";
  std::string files;
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) {
    if (!file.is_regular_file()) continue;
    files +=
        part(file.path().string().substr(folder.size()), read_text_file(file.path(), {kMostDroppedBytes}));
  }
  const auto options = [this] { return nlohmann::json::parse(*view_->options()); };
  const auto before = options();
  EXPECT_EQ(drop(part("a.urdf", "<robot/>") + "--b--\r\n").status, 400) << "no robot that can be read";
  EXPECT_EQ(drop(part("../a.urdf", "<robot/>") + "--b--\r\n").status, 400);
  EXPECT_EQ(drop("{}", "application/json").status, 415);
  EXPECT_EQ(drop("", "multipart/form-data; boundary=b", kMostDroppedBytes + 1).status, 413);
  EXPECT_EQ(options(), before);
  const RawAnswer dropped = drop(files + "--b--\r\n");
  EXPECT_EQ(dropped.status, 204) << dropped.body;
  const std::uint64_t now = view_->next_frame(0, std::chrono::seconds(60)).number;
  view_->next_frame(now, std::chrono::seconds(60));
  EXPECT_TRUE(options().at("robot").get<std::string>().ends_with("/robot.yaml"));
  EXPECT_NE(options().at("mass"), before.at("mass"));
}

// Each may be 64 MiB, and there are sixteen threads that would read them.
TEST_F(ViewServerTest, TakesOneDropAtATime) {
  const std::string body =
      "--b\r\nContent-Disposition: form-data; name=\"a.urdf\"\r\n\r\n<robot/>\r\n--b--\r\n";
  const std::string head =
      "POST " + at("/drop") + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) +
      "\r\nContent-Type: multipart/form-data; boundary=b\r\nContent-Length: " + std::to_string(body.size()) +
      "\r\n\r\n";
  bool refused = false;
  for (int i = 0; i < 20 && !refused; ++i) {
    const RawConnection first(port_);
    first.send(head + body.substr(0, 20));
    for (int k = 0; k < 20 && !refused; ++k) {
      const RawAnswer second = ask(port_, head + body);
      refused = second.status == 503;
      if (refused) {
        EXPECT_EQ(second.body, "other files are being dropped: again, once those are there\n");
      }
    }
    first.send(body.substr(20));
    static_cast<void>(first.read_all());
  }
  EXPECT_TRUE(refused);
  EXPECT_EQ(ask(port_, head + body).status, 400) << "no robot, and its turn";
}

TEST_F(ViewServerTest, TwoLookOnAtOnce) {
  const RawConnection a(port_), b(port_);
  for (const RawConnection* each : {&a, &b}) each->send(request_text("GET", at("/frames"), port_));
  for (const RawConnection* each : {&a, &b}) {
    const std::string text = each->read_until("data: ", 4);
    EXPECT_NE(text.find("text/event-stream"), std::string::npos);
    EXPECT_NE(text.find("\"robots\""), std::string::npos);
  }
}

TEST_F(ViewServerTest, WhoNeverReadsHoldsNothingUp) {
  start(1);
  const RawConnection deaf(port_, 4096);
  deaf.send(request_text("GET", at("/frames"), port_));
  deaf.read_until("data: ", 1);  // it has its place, and reads no more
  // Once its buffers are full it is let go, and its place is free: until then others are told to wait.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(100);
  bool waited = false;
  std::string answer;
  while (answer.find("data: ") == std::string::npos && std::chrono::steady_clock::now() < deadline) {
    const RawConnection other(port_);
    other.send(request_text("GET", at("/frames"), port_));
    answer = other.read_until("\n\n", 1);  // a frame, or the end of the refusal
    waited |= answer.find(" 503 ") != std::string::npos;
    std::uint64_t seen = view_->next_frame(0, std::chrono::seconds(60)).number;
    EXPECT_GT(view_->next_frame(seen, std::chrono::seconds(60)).number, seen) << "time goes on";
  }
  EXPECT_TRUE(waited);
  EXPECT_NE(answer.find("data: "), std::string::npos);
}

/// Sends a little more of a request again and again, as long as it lives.
class SlowSender {
 public:
  SlowSender(const RawConnection& to, std::string piece)
      : thread_([&to, piece = std::move(piece)](const std::stop_token& ended) {
          for (; !ended.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(50)))
            to.send(piece);
        }) {}

 private:
  std::jthread thread_;
};

// Who sends a request line by line, or a body byte by byte, has no more time than who says nothing.
TEST_F(ViewServerTest, WhoSendsSlowlyIsLetGo) {
  const RawConnection heads(port_), body(port_);
  heads.send("GET / HTTP/1.1\r\n");
  body.send("POST " + at("/command") + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) +
            "\r\nContent-Type: application/json\r\nContent-Length: 1000000000\r\n\r\n");
  const SlowSender header(heads, "X: a\r\n"), byte(body, "{");
  EXPECT_TRUE(heads.ends());
  EXPECT_TRUE(body.ends());
}

TEST_F(ViewServerTest, AnswersThoughManySayNothing) {
  std::vector<std::unique_ptr<RawConnection>> silent;
  for (int i = 0; i < 300; ++i) silent.push_back(std::make_unique<RawConnection>(port_));
  EXPECT_EQ(get(at("/")).status, 200);  // reading gives up after a minute
}

// Faster than those that say nothing are let go, and with more of them than may wait.
TEST_F(ViewServerTest, AnswersAllThoughSilentOnesKeepComing) {
  std::vector<std::unique_ptr<RawConnection>> silent;
  const std::jthread coming([&](const std::stop_token& ended) {
    for (; !ended.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
      if (silent.size() == 800) silent.erase(silent.begin());
      silent.push_back(std::make_unique<RawConnection>(port_));
      silent.back()->send("GET / HTTP/1.1\r\n");
    }
  });
  for (int i = 0; i < 30; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(100)))
    ASSERT_EQ(get(at("/")).status, 200) << "request " << i;
}

TEST_F(ViewServerTest, RefusesAHeadWithoutEnd) {
  for (const std::size_t size : {1000, 9000, 40'000, 400'000}) {
    const RawConnection endless(port_);
    endless.send("GET " + at("/") + " HTTP/1.1\r\nX: " + std::string(size, 'a'));
    EXPECT_TRUE(endless.ends()) << size;
  }
}

TEST_F(ViewServerTest, SendsEverythingWhole) {
  const RawAnswer part = get(at("/"), "Range: bytes=0-1\r\n");
  EXPECT_EQ(part.status, 200);
  EXPECT_EQ(part.body, "<p>page</p>");
  std::string ranges = "Range: bytes=0-";
  for (int i = 0; i < 1000; ++i) ranges += ",0-";
  EXPECT_EQ(get(at("/"), ranges + "\r\n").body, "<p>page</p>");
}

TEST_F(ViewServerTest, APortBelongsToOneServer) {
  EXPECT_EQ(config_error([this] {
              const ViewServer second(*view_, {.port = port_, .page = "", .token = kToken});
            }).element(),
            "port");
}

TEST_F(ViewServerTest, EndsWhileClientsAreThere) {
  const RawConnection watching(port_), silent(port_);
  watching.send(request_text("GET", at("/frames"), port_));
  watching.read_until("data: ", 1);
  server_.reset();
  // What was on its way may have been read already: the end is what counts.
  EXPECT_TRUE(watching.ends());
  EXPECT_TRUE(silent.ends());
}

TEST_F(ViewServerTest, EndsThoughAClientSendsOn) {
  const RawConnection slow(port_);
  slow.send("GET / HTTP/1.1\r\n");
  const SlowSender header(slow, "X: a\r\n");
  server_.reset();
  EXPECT_TRUE(slow.ends());
}

}  // namespace
}  // namespace crossgait
