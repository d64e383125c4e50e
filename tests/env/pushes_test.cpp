#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "env/randomisation.h"

namespace crossgait {
namespace {

constexpr double kControlDt = 2e-3;  // of a control step, s

struct Push {
  double time;
  Vector3 impulse;
  bool operator==(const Push&) const = default;
};

Randomisation ranges(const Range& impulse, const Range& interval, double count) {
  Randomisation r;
  r[Randomised::kPushImpulse] = impulse;
  r[Randomised::kPushInterval] = interval;
  r[Randomised::kPushCount] = {count, count};
  return r;
}

Pushes drawn(const Randomisation& randomisation, std::uint64_t seed, RandomDraw* draw_of_it = nullptr) {
  Random random(seed);
  const RandomDraw first = draw(randomisation, random);
  if (draw_of_it != nullptr) *draw_of_it = first;
  return pushes_of(randomisation, first, random);
}

/// All that are due in control steps of ten seconds, from step `begin` on.
std::vector<Push> due(Pushes& pushes, int begin = 0, int end = 5000) {
  std::vector<Push> all;
  for (int i = begin; i < end; ++i) {
    if (const auto impulse = pushes.due(i * kControlDt)) all.push_back({i * kControlDt, *impulse});
  }
  return all;
}

TEST(Pushes, NoneUnlessAskedFor) {
  Pushes none;
  EXPECT_TRUE(due(none).empty());
  Pushes off = drawn({}, 1);
  EXPECT_TRUE(due(off).empty());
}

TEST(Pushes, ComeOneIntervalApartTheFirstAfterTheFirst) {
  Pushes pushes = drawn(ranges({0.01, 0.02}, {0.5, 0.5}, 0), 1);
  const std::vector<Push> all = due(pushes);
  ASSERT_EQ(all.size(), 19U);  // at 0.5, 1, ... 9.5 s
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_DOUBLE_EQ(all[k].time, 0.5 * static_cast<double>(k + 1));
    EXPECT_EQ(all[k].impulse.z(), 0);
    EXPECT_GE(all[k].impulse.norm(), 0.01 - 1e-15);  // rounding of sine and cosine
    EXPECT_LE(all[k].impulse.norm(), 0.02 + 1e-15);
    if (k > 0) {
      EXPECT_NE(all[k].impulse, all[k - 1].impulse);
    }
  }
}

TEST(Pushes, AreDueInTheFirstStepThatIsNotBeforeThem) {
  // Times that are no multiple of the step: drawn ones.
  const Randomisation r = ranges({0.01, 0.01}, {0.1, 0.9}, 0);
  RandomDraw first;
  Pushes pushes = drawn(r, 3, &first);
  // The same draws once more: impulse, direction, interval of each.
  Random random(3);
  static_cast<void>(draw(r, random));
  double expected = first[Randomised::kPushInterval];
  const std::vector<Push> all = due(pushes);
  ASSERT_GT(all.size(), 3U);
  for (const Push& push : all) {
    EXPECT_GE(push.time, expected);
    EXPECT_LT(push.time, expected + kControlDt);
    const double impulse = random.uniform(0.01, 0.01), angle = random.uniform(-M_PI, M_PI);
    EXPECT_EQ(push.impulse, Vector3(impulse * std::cos(angle), impulse * std::sin(angle), 0));
    expected += random.uniform(0.1, 0.9);
  }
}

TEST(Pushes, StopAtTheirNumber) {
  for (const int count : {1, 3}) {
    Pushes pushes = drawn(ranges({0.01, 0.01}, {0.2, 0.4}, count), 5);
    EXPECT_EQ(due(pushes).size(), static_cast<std::size_t>(count));
  }
}

TEST(Pushes, CopiesGoOnAlikeAndSeedsDoNot) {
  const Randomisation r = ranges({0.01, 0.05}, {0.1, 0.9}, 0);
  Pushes pushes = drawn(r, 7), same = drawn(r, 7), other = drawn(r, 8);
  const std::vector<Push> begun = due(pushes, 0, 2000);
  EXPECT_EQ(due(same, 0, 2000), begun);
  EXPECT_NE(due(other, 0, 2000), begun);
  Pushes copy = pushes;
  const std::vector<Push> rest = due(pushes, 2000);
  EXPECT_GT(rest.size(), 3U);
  EXPECT_EQ(due(copy, 2000), rest);
}

}  // namespace
}  // namespace crossgait
