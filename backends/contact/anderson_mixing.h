// Where an iteration leads to, judged by its last steps.
#pragma once

#include <Eigen/Core>

namespace crossgait::contact {

/// Replaces points of a fixed-point iteration by mixtures of the last ones, in shares that would leave the
/// least step (Anderson 1965), every few steps, with plain ones between (Pratapa, Suryanarayana and Pask
/// 2016). Where the iteration is linear that is a Krylov method. Where it bends, a mixture that does not make
/// the step shorter is taken back, and the next is twice as far off: in the end it is the plain iteration.
class AndersonMixing {
 public:
  /// Allocates for points of up to `most` numbers, and never after.
  explicit AndersonMixing(int most)
      : weights_(most), kept_(most), ends_(most, kPoints), steps_(most, kPoints) {}

  /// Begins another iteration of points of `size` numbers.
  void begin(int size) noexcept;
  /// Returns the weight of each number in the square of a step, by its root: to be filled in after `begin`.
  Eigen::Ref<Eigen::VectorXd> weights() noexcept { return weights_.head(size_); }
  /// Takes a step of the iteration. @param size  of the step, in whatever it ends by
  /// @returns whether the iteration is to go on from elsewhere, which is in `after` then
  bool replace(const Eigen::Ref<const Eigen::VectorXd>& before, Eigen::Ref<Eigen::VectorXd> after,
               double size) noexcept;

 private:
  static constexpr int kPoints = 6;  // that are mixed
  static constexpr int kPlain = 4;   // steps between mixtures
  // What a mixture has to make of the step before it. Where rows contradict each other the iteration drifts,
  // by the same step for ever, and a mixture would lead far along.
  static constexpr double kShorter = 0.9;

  bool mix(Eigen::Ref<Eigen::VectorXd> point) const noexcept;

  Eigen::VectorXd weights_;
  Eigen::VectorXd kept_;          // the point before the mixture
  Eigen::MatrixXd ends_, steps_;  // a column for each of the last points, in turns
  int size_ = 0, count_ = 0;
  int plain_ = kPlain, until_ = 0;  // steps between mixtures, and to the next
  double size_before_ = 0;          // of the step before the mixture; 0 where none was made
};

}  // namespace crossgait::contact
