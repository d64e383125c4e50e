// From the table's blocks to what a policy sees.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "env/observation.h"
#include "env/observation_term.h"
#include "physics/core/random.h"

namespace crossgait {

/// Observes what a policy sees, term by term (ObservationTerm). A value that remembers what it saw: a copy
/// goes on from there.
class Observer {
 public:
  Observer() = default;
  /// @param policy_dt, control_dt  s; delays are whole multiples of the latter
  /// @throws ConfigError for a bad term, or an entry that is seen twice
  Observer(const std::vector<ObservationTerm>& terms, const ObservationContext& context, double policy_dt,
           double control_dt);

  /// Describes the observation, one entry per number. What a scale changes is in its unit, what is seen late
  /// in its name: "v_B.x@0.02" is that of 0.02 s ago.
  const Layout& layout() const noexcept { return layout_; }

  /// Begins an episode. @param seed  of the noise
  void restart(std::uint64_t seed) noexcept;
  /// Tells whether `look` wants to be called after each control step within a policy step, for delays that
  /// end there.
  bool samples_substeps() const noexcept { return samples_substeps_; }
  void sample(const ObservationSource& source) noexcept;
  /// Looks at the world, and writes what is to be seen. @param out  of layout().size()
  void observe(const ObservationSource& source, std::span<double> out) noexcept;

 private:
  struct Term {
    const ObservationBlock* block;
    std::vector<double> scale;  // one per number; empty: 1
    double clip, clip_unscaled, noise;
    std::size_t size;            // numbers of the block
    int delay = 0, spacing = 1;  // in looks: to the newest that is seen, and from there to the one before
    int history = 1;
    bool remembered;
    std::size_t begin = 0;  // in a row of the memory
    bool plain = false;     // seen as it is
  };

  /// Adds what a term shows of one instant: `age` policy steps before the newest that it sees.
  void add_entries(const ObservationTerm& term, const Layout& block, int age, double policy_dt);
  void describe(const std::vector<ObservationTerm>& terms, const std::vector<Layout>& blocks,
                double policy_dt);
  double* recall(const Term& term, int age, double* out) const noexcept;
  int age_at(int place, int history) const noexcept;
  void write(const Term& term, const ObservationSource& source, double* out) noexcept;

  Layout layout_;
  std::vector<Term> terms_;
  HistorySettings history_;
  std::vector<double> memory_;  // a row per look, the last of them at newest_
  std::size_t row_ = 0;         // numbers in it
  int rows_ = 0, newest_ = 0;
  bool samples_substeps_ = false, empty_ = true;
  Random noise_;
};

}  // namespace crossgait
