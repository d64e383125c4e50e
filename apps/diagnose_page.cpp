#include "apps/diagnose_page.h"

#include <fmt/format.h>

#include "policy/relabelled_policy.h"
#include "report/watched_episodes.h"
#include "study/rollout.h"

namespace crossgait::apps {
namespace {

PageTable ranking_of(const Diagnosis& found) {
  PageTable page{.table = ranking_table(found),
                 .title = "What a change takes away of the score",
                 .note = deciding_sentence(found)};
  IntervalColumn effects{"effect, score", {}};
  for (const RankedChange& change : found.ranking) {
    effects.rows.emplace_back(Interval{change.effect, change.low, change.high});
    std::vector<Mark>& marks = page.marks.emplace_back(page.table.rows().front().size(), Mark::kNone);
    marks.back() = change.cures ? Mark::kGood : Mark::kBad;
  }
  page.intervals = std::move(effects);
  return page;
}

PageTable walks_of(const Diagnosis& found) {
  PageTable page{.table = walks_table(found), .title = "What it was asked, and did"};
  for (const bool done : walks_done(found))
    page.marks.push_back({Mark::kNone, Mark::kNone, done ? Mark::kGood : Mark::kBad});
  return page;
}

PageTable tests_of(const Diagnosis& found) {
  PageTable page{.table = tests_table(found, true), .title = "What is known without walking"};
  for (const StandingTest& test : found.tests)
    page.marks.push_back({Mark::kNone, !test.judged ? Mark::kNone : test.passed ? Mark::kGood : Mark::kBad});
  return page;
}

}  // namespace

ReportPage diagnose_page(const Diagnosis& found, const LoadedEnv& environment, const std::string& policy,
                         std::uint64_t seed) {
  ReportPage page;
  page.title = fmt::format("Diagnosis of {} in {}", short_name(policy), environment.config.engine);
  page.summary = found.summary;
  if (!found.ranking.empty()) page.tables.push_back(ranking_of(found));
  page.tables.push_back(walks_of(found));
  page.tables.push_back(tests_of(found));
  const NamedPolicy walked{policy, read_relabelled_policy(policy).make};
  const std::vector<CommandResult> given = by_command(found.as_given, found.test.seeds);
  for (std::size_t c = 0; c < given.size(); ++c) {
    const WalkCommand& command = found.test.commands[c];
    const std::size_t start = found.test.first + given[c].worst;
    std::vector<WatchedEpisode> walks{
        {"as given", walk_environment(environment, found.test, command), walked, start}};
    if (found.changed) {
      walks.push_back({"with the change",
                       walk_environment(environment.with(found.environment), found.test, command), walked,
                       start});
    }
    Motion& motion = page.motions.emplace_back(watch_episodes(walks, seed));
    motion.name = command.name;
    motion.side_by_side = true;
  }
  return page;
}

}  // namespace crossgait::apps
