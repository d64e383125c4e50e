// The session in its thread: frames keep coming, commands are done or refused, whoever asks.
#include "view/live_view.h"

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "tests/physics/core/config_error.h"
#include "tests/view/view_setup.h"

namespace crossgait {
namespace {

using namespace std::chrono_literals;

class LiveViewTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (available_engines().empty()) GTEST_SKIP() << "no engine";
    view_ = std::make_unique<LiveView>(make_view_session({available_engines().front()}));
  }
  /// The next frame that is not `seen`; frames come every 20 ms, so a minute is for what hangs.
  nlohmann::json next(std::uint64_t& seen) {
    const LiveFrame frame = view_->next_frame(seen, 60s);
    EXPECT_GT(frame.number, seen);
    seen = frame.number;
    return nlohmann::json::parse(*frame.json);
  }
  std::unique_ptr<LiveView> view_;
};

TEST_F(LiveViewTest, TimePassesFromFrameToFrame) {
  std::uint64_t seen = 0;
  double time = -1;
  for (int i = 0; i < 5; ++i) {
    const double now = next(seen).at("robots").at(0).at("time");
    EXPECT_GT(now, time);
    time = now;
  }
  EXPECT_EQ(view_->failure(), "");
}

TEST_F(LiveViewTest, ACommandIsDoneWhenItReturns) {
  view_->execute(DriveCommand{{0.1, 0, 0}});
  std::uint64_t seen = view_->next_frame(0, 0ms).number;
  EXPECT_EQ(next(seen).at("command").at("vx"), 0.1);
  EXPECT_EQ(config_error([this] { view_->execute(DriveCommand{{99, 0, 0}}); }).element(), "vx");
  EXPECT_EQ(next(seen).at("command").at("vx"), 0.1);
}

TEST_F(LiveViewTest, SeveralMayCommandAtOnce) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([this] {
      for (int k = 0; k < 5; ++k) view_->execute(PushCommand{{0, 0.001, 0}});
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(view_->failure(), "");
}

TEST_F(LiveViewTest, TheSceneChangesWithTheGround) {
  const auto before = view_->scene();
  view_->execute(TerrainCommand{"waves:size_x=2,size_y=2", 0});
  std::uint64_t seen = view_->next_frame(0, 0ms).number;
  next(seen);
  EXPECT_NE(*view_->scene(), *before);
  EXPECT_EQ(nlohmann::json::parse(*view_->scene()).at("revision"), next(seen).at("scene"));
}

TEST_F(LiveViewTest, EndsWhileSomebodyWatches) {
  std::thread watcher([this] {
    std::uint64_t seen = 0;
    for (int i = 0; i < 3; ++i) seen = view_->next_frame(seen, 60s).number;
  });
  watcher.join();
  view_.reset();
}

}  // namespace
}  // namespace crossgait
