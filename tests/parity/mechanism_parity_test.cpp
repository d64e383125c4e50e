// Closed mechanisms in engines of one law: a nanometre or two apart at most after two seconds of trot.
#include "tests/parity/matched_pair.h"

namespace crossgait {
namespace {

class MatchedMechanisms : public MatchedPair {};
INSTANTIATE_TEST_SUITE_P(Engines, MatchedMechanisms, ::testing::ValuesIn(matched_pairs()), pair_name);

constexpr double kMostApart = 1e-8;  // m and rad, of 2 s: rounding, grown by touch-downs

TEST_P(MatchedMechanisms, FiveBarsWithoutTiltsTrotAlike) {
  for (const double apart : {0.0, 0.04}) {
    SCOPED_TRACE(apart);
    const Difference d = trot(scenes::world_of(scenes::planar_five_bars(apart)), 2);
    EXPECT_LT(d.position, kMostApart);
    EXPECT_LT(d.joints, kMostApart);
    EXPECT_GE(d.most_contacts, 2);
  }
}

TEST_P(MatchedMechanisms, KneesAndAnklesOnBarsTrotAlike) {
  for (const auto& robot : {scenes::four_bar_knees(), scenes::pantographs()}) {
    SCOPED_TRACE(robot->name);
    const Difference d = trot(scenes::world_of(robot), 2);
    EXPECT_LT(d.position, kMostApart);
    EXPECT_LT(d.joints, kMostApart);
    EXPECT_GE(d.most_contacts, 2);
  }
}

}  // namespace
}  // namespace crossgait
