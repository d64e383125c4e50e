// What a policy sees of a block: recomputed from what an environment that sees everything plainly saw.
#include "env/observer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

using Rows = std::vector<std::vector<double>>;

EnvConfig seeing(const std::vector<ObservationTerm>& terms) {
  EnvConfig config;
  config.control_dt = 2e-3;
  config.policy_dt = 6e-3;
  config.observation = terms;
  return config;
}

/// What is seen at reset and after each of `steps` steps of the plain gait.
Rows rows_of(const EnvConfig& config, const std::string& engine, int steps, std::uint64_t seed = 1) {
  QuadrupedEnv env(config, find_engine(engine));
  Rows rows(static_cast<std::size_t>(steps) + 1, std::vector<double>(env.observation_size()));
  env.reset(seed, rows[0]);
  const std::vector<double> action(env.action_size(), 0);
  for (std::size_t i = 1; i < rows.size(); ++i) env.step(action, rows[i]);
  return rows;
}

template <typename Action>
std::string message(const Action& action) {
  return config_error(action).what();
}

ObservationTerm term(const char* block, const std::function<void(ObservationTerm&)>& change) {
  ObservationTerm made = block;
  change(made);
  return made;
}

class Observers : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Observers);

TEST_P(Observers, ClipBeforeTheScaleToo) {
  const Rows plain = rows_of(seeing({"joint_velocities"}), GetParam(), 40);
  const Rows seen = rows_of(seeing({term("joint_velocities",
                                         [](ObservationTerm& t) {
                                           t.scale = {-0.5};
                                           t.clip_unscaled = 0.4;
                                         })}),
                            GetParam(), 40);
  bool clipped = false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t k = 0; k < 12; ++k) {
      EXPECT_EQ(seen[i][k], -0.5 * std::clamp(plain[i][k], -0.4, 0.4));
      clipped = clipped || std::abs(plain[i][k]) > 0.4;
    }
  }
  EXPECT_TRUE(clipped);
}

// Every layout of two blocks' last three instants, from what was seen of them plainly.
TEST_P(Observers, HistoryByTermOrFrameInEitherOrder) {
  using By = HistorySettings::By;
  using Order = HistorySettings::Order;
  using Before = HistorySettings::Before;
  const Rows plain = rows_of(seeing({"base_angular_velocity", "command"}), GetParam(), 6);
  const auto remembered = [](ObservationTerm& t) { t.history = 3; };
  for (const By by : {By::kTerm, By::kFrame}) {
    for (const Order order : {Order::kNewestFirst, Order::kOldestFirst}) {
      for (const Before before : {Before::kFirst, Before::kZeros}) {
        EnvConfig config = seeing({term("base_angular_velocity", remembered), term("command", remembered)});
        config.observing.history = {by, order, before};
        const Rows seen = rows_of(config, GetParam(), 6);
        for (std::size_t i = 0; i < seen.size(); ++i) {
          for (std::size_t place = 0; place < 18; ++place) {
            const std::size_t block = by == By::kTerm ? place / 9 : place / 3 % 2;
            const std::size_t instant = by == By::kTerm ? place / 3 % 3 : place / 6;
            const std::size_t age = order == Order::kNewestFirst ? instant : 2 - instant;
            const double value = plain[age > i ? 0 : i - age][3 * block + place % 3];
            EXPECT_EQ(seen[i][place], age > i && before == Before::kZeros ? 0 : value) << i << " " << place;
          }
        }
      }
    }
  }
}

TEST_P(Observers, SeeAClockAGridAndConstants) {
  EnvConfig config = seeing({"clock_sin", "clock_cos", "constants", "height_scan", "base_position",
                             "base_orientation", "base_orientation_xyzw", "roll_pitch_yaw"});
  config.terrain = "rough";
  config.observing.clock = {2.5, {0, 0.5}};
  config.observing.constants = {3, -1};
  config.observing.height_scan = {{-0.1, 0, 0.1}, {0.05}, 0.02, true};
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(1, seen);
  for (int i = 1; i <= 10; ++i) env.step(std::vector<double>(env.action_size()), seen);
  const double angle = 2 * M_PI * 2.5 * 10 * config.policy_dt;  // less than a turn
  constexpr double kRounding = 1e-12;                           // of products of numbers of order 1
  EXPECT_NEAR(seen[0], std::sin(angle), kRounding);
  EXPECT_NEAR(seen[1], std::sin(angle + M_PI), kRounding);
  EXPECT_NEAR(seen[2], std::cos(angle), kRounding);
  EXPECT_EQ(seen[4], 3);
  EXPECT_EQ(seen[5], -1);
  const RobotState& state = env.world().state();
  const Vector3 turn = roll_pitch_yaw(state.q_WB);
  for (int k = 0; k < 3; ++k) {
    const double x = 0.1 * (k - 1), y = 0.05, c = std::cos(turn.z()), s = std::sin(turn.z());
    const double ground =
        env.world().spec().terrain.height(state.p_WB.x() + c * x - s * y, state.p_WB.y() + s * x + c * y);
    EXPECT_NEAR(seen[6 + static_cast<std::size_t>(k)], state.p_WB.z() - ground - 0.02, kRounding);
  }
  const double* wxyz = &seen[12];
  const double* xyzw = &seen[16];
  for (int k = 0; k < 4; ++k) EXPECT_EQ(xyzw[(k + 3) % 4], wxyz[k]);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(seen[20 + static_cast<std::size_t>(k)], turn[k]);
}

TEST(ObserverSettings, SayNothingThatNoBlockShows) {
  const auto complaint = [](const auto& change) {
    EnvConfig config = seeing({"command"});
    change(config);
    return message([&] { config.validate(); });
  };
  EXPECT_NE(
      complaint([](EnvConfig& c) { c.observing.constants = {1}; }).find("constants: expected constants in"),
      std::string::npos);
  EXPECT_NE(
      complaint([](EnvConfig& c) { c.observation = {"height_scan"}; }).find("height_scan: expected what"),
      std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.observation = {"clock_sin"};
              c.observing.clock = {0, {0}};
            }).find("clock.frequency"),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.observing.history.by = HistorySettings::By::kFrame;
            }).find("history.by: expected blocks with a history of 2 or more"),
            std::string::npos);
}

TEST_P(Observers, ScaleThenClip) {
  const Rows plain = rows_of(seeing({"joint_velocities", "command"}), GetParam(), 40);
  EnvConfig config = seeing({term("joint_velocities",
                                  [](ObservationTerm& t) {
                                    t.scale = {0.05};
                                    t.clip = 0.1;
                                  }),
                             term("base_angular_velocity", [](ObservationTerm& t) {
                               t.scale = {2, -1, 0.5};
                             })});
  const Rows seen = rows_of(config, GetParam(), 40);
  const Rows turning = rows_of(seeing({"base_angular_velocity"}), GetParam(), 40);
  bool clipped = false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t k = 0; k < 12; ++k) {
      EXPECT_EQ(seen[i][k], std::clamp(0.05 * plain[i][k], -0.1, 0.1));
      clipped = clipped || std::abs(seen[i][k]) == 0.1;
    }
    EXPECT_EQ(seen[i][12], 2 * turning[i][0]);
    EXPECT_EQ(seen[i][13], -turning[i][1]);
    EXPECT_EQ(seen[i][14], 0.5 * turning[i][2]);
  }
  EXPECT_TRUE(clipped);
}

TEST_P(Observers, HistoryIsNewestFirstAndBeginsWithTheFirst) {
  const Rows plain = rows_of(seeing({"joint_positions"}), GetParam(), 20);
  const EnvConfig config =
      seeing({term("joint_positions", [](ObservationTerm& t) { t.history = 3; }), "height"});
  const Rows seen = rows_of(config, GetParam(), 20);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t back = 0; back < 3; ++back) {
      const std::vector<double>& then = plain[i < back ? 0 : i - back];
      for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(seen[i][12 * back + k], then[k]) << i << ", " << back;
    }
  }
}

TEST_P(Observers, DelaysOfPolicyStepsAndOfControlSteps) {
  // The finest look at the same motion: a policy step per control step.
  EnvConfig fine = seeing({"joint_positions"});
  fine.policy_dt = fine.control_dt;
  const Rows every = rows_of(fine, GetParam(), 60);
  for (const int late : {1, 2, 3, 4, 6, 10}) {  // control steps; three of them make a policy step
    const double delay = late * fine.control_dt;
    const EnvConfig config = seeing({term("joint_positions", [delay](ObservationTerm& t) {
      t.delay = delay;
      t.history = 2;
    })});
    const Rows seen = rows_of(config, GetParam(), 20);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (int back = 0; back < 2; ++back) {
        const int at = 3 * (static_cast<int>(i) - back) - late;
        const std::vector<double>& then = every[static_cast<std::size_t>(std::max(at, 0))];
        for (std::size_t k = 0; k < 12; ++k)
          ASSERT_EQ(seen[i][12 * static_cast<std::size_t>(back) + k], then[k])
              << late << " steps late, row " << i << ", " << back << " back";
      }
    }
  }
}

TEST_P(Observers, NoiseIsUniformAndOfTheEpisodesSeed) {
  const Rows plain = rows_of(seeing({"joint_positions"}), GetParam(), 200);
  const EnvConfig config = seeing({term("joint_positions", [](ObservationTerm& t) {
    t.noise = 0.02;
    t.scale = {10};
  })});
  const Rows seen = rows_of(config, GetParam(), 200);
  double least = 0, most = 0, sum = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t k = 0; k < 12; ++k) {
      const double n = seen[i][k] / 10 - plain[i][k];
      least = std::min(least, n);
      most = std::max(most, n);
      sum += n;
      squares += n * n;
      ++count;
    }
  }
  EXPECT_GT(least, -0.02 - 1e-12);
  EXPECT_LT(most, 0.02 + 1e-12);
  // 2412 numbers: mean within 4 standard errors of 0, variance within 10 % of that of the uniform law.
  EXPECT_LT(std::abs(sum / count), 4 * 0.02 / std::sqrt(3 * count));
  EXPECT_NEAR(squares / count, 0.02 * 0.02 / 3, 0.1 * 0.02 * 0.02 / 3);
  EXPECT_EQ(rows_of(config, GetParam(), 5), Rows(seen.begin(), seen.begin() + 6));
  EXPECT_NE(rows_of(config, GetParam(), 5, 2)[0], seen[0]);
}

TEST_P(Observers, AnEndedEpisodeShowsItsLastInstantAgain) {
  EnvConfig config = seeing({term("joint_positions", [](ObservationTerm& t) {
    t.history = 2;
    t.noise = 0.1;
  })});
  config.episode_seconds = 3 * config.policy_dt;
  const Rows rows = rows_of(config, GetParam(), 6);
  EXPECT_NE(rows[3], rows[2]);
  for (std::size_t i = 4; i < rows.size(); ++i) EXPECT_EQ(rows[i], rows[3]);
}

TEST(Observer, NamesUnitsAndBoundsSayWhatIsSeen) {
  EnvConfig config = seeing({term("base_orientation",
                                  [](ObservationTerm& t) {
                                    t.scale = {-2};
                                    t.noise = 0.25;
                                    t.history = 2;
                                    t.delay = 2e-3;
                                  }),
                             term("joint_velocities",
                                  [](ObservationTerm& t) {
                                    t.scale = {0.05};
                                    t.clip = 3;
                                  }),
                             "gravity"});
  const Layout layout = EnvModel::make(config)->interface.observation;
  ASSERT_EQ(layout.size(), 8U + 12U + 3U);
  EXPECT_EQ(layout.entries[0], (LayoutEntry{"q_WB.w@0.002", "- x -2", -2.5, 2.5, 2e6}));
  EXPECT_EQ(layout.entries[4].name, "q_WB.w@0.008");
  EXPECT_EQ(layout.entries[8].name, "qd.FL_tilt");
  EXPECT_EQ(layout.entries[8].unit, "rad/s x 0.05");
  EXPECT_EQ(layout.entries[8].min, -3);
  EXPECT_EQ(layout.entries[8].max, 3);
  EXPECT_EQ(layout.entries[8].reach, 50) << "0.05 of 1000 rad/s";
  EXPECT_EQ(layout.entries[20], (LayoutEntry{"gravity_B.x", "-", -1, 1}));
}

TEST(Observer, RefusesWhatIsSeenTwice) {
  EnvConfig config = seeing({term("gravity", [](ObservationTerm& t) { t.history = 3; }),
                             term("gravity", [](ObservationTerm& t) { t.delay = 12e-3; })});
  EXPECT_EQ(message([&] { static_cast<void>(EnvModel::make(config)); }),
            "observation: blocks: expected every entry once, found gravity_B.x@0.012 twice");
  config.observation[1].delay = 18e-3;
  EXPECT_EQ(EnvModel::make(config)->interface.observation.size(), 12U);
}

TEST(Observer, RefusesTermsThatMeanNothing) {
  const auto complaint = [](const std::function<void(ObservationTerm&)>& change) {
    return message([&] { static_cast<void>(EnvModel::make(seeing({term("gravity", change)}))); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint([](ObservationTerm& t) { t.scale = {0}; }),
            "environment: observation, scale of gravity: expected a finite number but 0, found 0");
  EXPECT_EQ(complaint([](ObservationTerm& t) {
              t.scale = {1, 2};
            }),
            "observation: scale of gravity: expected one number or 3, found 2");
  EXPECT_EQ(complaint([](ObservationTerm& t) { t.clip = 0; }),
            "environment: observation, clip of gravity: expected a number above 0, found 0");
  EXPECT_EQ(complaint([nan](ObservationTerm& t) { t.clip = nan; }),
            "environment: observation, clip of gravity: expected a number above 0, found nan");
  EXPECT_EQ(complaint([](ObservationTerm& t) { t.noise = -1; }),
            "environment: observation, noise of gravity: expected a number of 0 or more, found -1");
  EXPECT_EQ(complaint([](ObservationTerm& t) { t.history = 0; }),
            "environment: observation, history of gravity: expected 1 to 1000 policy steps, found 0");
  EXPECT_EQ(complaint([](ObservationTerm& t) { t.delay = 3e-3; }),
            "environment: observation, delay of gravity: expected a whole multiple of 0.002 s, found 0.003");
  EXPECT_EQ(
      complaint([](ObservationTerm& t) { t.delay = 2.002; }),
      "environment: observation, delay of gravity: expected at most 1000 control steps of 0.002 s, found "
      "2.002");
}

}  // namespace
}  // namespace crossgait
