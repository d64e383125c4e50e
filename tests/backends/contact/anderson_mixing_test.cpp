// Mixtures of an iteration's points against where it is known to lead.
#include "backends/contact/anderson_mixing.h"

#include <gtest/gtest.h>

namespace crossgait::contact {
namespace {

/// x <- M x + b with eigenvalues of M near one, which alone takes thousands of steps.
struct Linear {
  static constexpr int kSize = 4;
  Eigen::Vector4d rates{0.999, 0.99, 0.9, -0.5}, b{1, -2, 3, 4};

  Eigen::Vector4d fixed_point() const { return b.array() / (1 - rates.array()); }
  Eigen::VectorXd step(const Eigen::VectorXd& x) const {
    return (rates.array() * x.array() + b.array()).matrix();
  }
};

TEST(AndersonMixing, SolvesWhatIsLinear) {
  const Linear iteration;
  AndersonMixing mixing(10);
  mixing.begin(Linear::kSize);
  mixing.weights() << 1, 2, 3, 4;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(Linear::kSize);
  int steps = 0;
  while ((x - iteration.fixed_point()).norm() > 1e-6 * iteration.fixed_point().norm() && steps < 100) {
    Eigen::VectorXd after = iteration.step(x);
    mixing.replace(x, after, (after - x).norm());
    x = after;
    ++steps;
  }
  // Six points span the four directions; two more mixtures for what rounding left. Alone: 13,800 steps.
  EXPECT_LE(steps, 15);
}

TEST(AndersonMixing, TakesBackWhatLedAway) {
  AndersonMixing mixing(1);
  mixing.begin(1);
  mixing.weights().setOnes();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(1), after(1);
  double last = 0;
  bool mixed = false;
  for (int i = 0; i < 100 && !mixed; ++i) {  // x <- 0.9 x + 1
    after[0] = last = 0.9 * x[0] + 1;
    mixed = mixing.replace(x, after, after[0] - x[0]);
    x = after;
  }
  ASSERT_TRUE(mixed);
  EXPECT_NEAR(x[0], 10, 1e-6);
  // As if the law bent on the way there: the step from the mixture is longer than all before it.
  after[0] = 25;
  EXPECT_TRUE(mixing.replace(x, after, 15));
  EXPECT_EQ(after[0], last);
}

TEST(AndersonMixing, GoesNowhereByADrift) {
  AndersonMixing mixing(1);
  mixing.begin(1);
  mixing.weights().setOnes();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
  int plain = 0;
  for (int i = 0; i < 1000; ++i) {  // x <- x + 1 + a little, that mixtures would undo by a jump
    Eigen::VectorXd after = x.array() + 1 + 1e-6 * (i % 2);
    plain += mixing.replace(x, after, after[0] - x[0]) ? 0 : 1;
    x = after;
  }
  EXPECT_GT(plain, 980);
  EXPECT_NEAR(x[0], 1000, 50);
}

TEST(AndersonMixing, LeavesAPointThatStandsStill) {
  AndersonMixing mixing(2);
  mixing.begin(2);
  mixing.weights().setOnes();
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(2);
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd after = x;
    EXPECT_FALSE(mixing.replace(x, after, 0));
    EXPECT_EQ(after, x);
  }
}

}  // namespace
}  // namespace crossgait::contact
