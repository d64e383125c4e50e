// crossgait matrix: where policies were trained against where they run.
#include "diagnosis/transfer_matrix.h"
#include <nlohmann/json.hpp>

#include "apps/page_option.h"
#include "apps/scored_policies.h"

namespace crossgait::apps {
namespace {

ReportPage page_of(const TransferMatrix& matrix, const std::vector<PolicyCell>& cells) {
  ReportPage page;
  page.title = "Trained in, run in";
  page.summary = matrix.summary;
  page.tables.push_back({.table = matrix_table(matrix),
                         .title = "Scores: trained in, run in",
                         .note = "0 is best, 3 and more a fall; * at home. In brackets 95 % intervals."});
  PageTable losses{.table = losses_table(matrix), .title = "What is lost away from home"};
  IntervalColumn column{"loss, score", {}};
  for (const MatrixEntry& entry : matrix.entries) {
    if (entry.loss) column.rows.emplace_back(*entry.loss);
  }
  losses.intervals = std::move(column);
  if (losses.table.rows().size() > 1) page.tables.push_back(std::move(losses));
  PageTable each{.table = scores_table(cells), .title = "Every policy in every engine"};
  for (const PolicyCell& cell : cells) {
    std::vector<Mark>& marks = each.marks.emplace_back(each.table.rows().front().size(), Mark::kNone);
    marks.back() = cell.done ? Mark::kGood : Mark::kBad;
  }
  page.tables.push_back(std::move(each));
  return page;
}

}  // namespace

void add_matrix_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "matrix", "Where policies were trained against where they run: what each home's lose elsewhere");
  command->footer(
      "\nScores every policy in every engine (`score`) and averages over those that were trained in one. "
      "Give "
      "several\nof a home, from other seeds: another training gives another policy, and intervals are then "
      "over "
      "policies.\n\nExamples:\n"
      "  crossgait matrix serial_joints --engines mujoco,bullet,dart\n"
      "  crossgait matrix runs/a runs/b walks/c --trained-in c=physx --report matrix.html");
  struct Options {
    ScoredPoliciesOptions scored;
    PageOption page;
  };
  auto options = std::make_shared<Options>();
  options->scored.add_to(*command, invocation)->required();
  options->page.add_to(*command, "Write a page with the tables and intervals, as one HTML file");
  on_run(*command, [options] {
    options->page.check();
    const ScoredPolicies scored = score_them(options->scored);
    const TransferMatrix matrix = transfer_matrix(scored.cells);
    if (options->page.asked()) options->page.write(page_of(matrix, scored.cells), scored.provenance);
    options->scored.json.emit(describe(matrix, scored.cells),
                              to_json(matrix, scored.cells, options->scored.how), scored.provenance);
  });
}

}  // namespace crossgait::apps
