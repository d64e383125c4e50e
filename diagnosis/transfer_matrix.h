// Where policies were trained against where they run: what each home's policies lose elsewhere.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/policy_score.h"

#include "parity/paired_differences.h"
#include "physics/core/table.h"

namespace crossgait {

/// Holds the policies of one home in one engine. Numbers are means over the policies and intervals the 95 %
/// ones of such a mean (Student's): over policies where there are two or more, since another training gives
/// another policy; else over the starts of the one that there is.
struct MatrixEntry {
  std::string trained_in;  ///< an engine, or "" of policies of which nobody says it
  std::string engine;      ///< in which they run
  std::size_t policies = 0;
  Interval score;  ///< 0 is best, 4 worst
  /// Score here less that at home, of the same policies; nothing at home, and where home is not among the
  /// engines.
  std::optional<Interval> loss;
};

/// Holds all of it.
struct TransferMatrix {
  std::vector<MatrixEntry> entries;  ///< home by home, as policies come, engines in their order
  std::string summary;               ///< a sentence or some
};

/// Makes the matrix of cells that `score_policies` returned.
TransferMatrix transfer_matrix(std::span<const PolicyCell> cells);

/// Returns homes by engines: scores with their intervals, with a star at home.
Table matrix_table(const TransferMatrix& matrix);
/// Returns what each home's policies lose in each other engine: the rows of entries that have a loss.
Table losses_table(const TransferMatrix& matrix);
/// Returns a row for each policy in each engine, in their order.
Table scores_table(std::span<const PolicyCell> cells);
/// Describes it: the sentences, a table of homes by engines, and the policies beneath.
std::string describe(const TransferMatrix& matrix, std::span<const PolicyCell> cells);
/// Returns what `crossgait matrix --json` writes.
nlohmann::ordered_json to_json(const TransferMatrix& matrix, std::span<const PolicyCell> cells,
                               const PolicyScoreOptions& options);

}  // namespace crossgait
