#include "diagnosis/search.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr std::size_t kSeeds = 3;
const std::string kAnd = " + ";  // between two changes
constexpr double kWholeSeconds = 3, kGlanceSeconds = 2;

bool moves(const WalkCommand& command) {
  const VelocityCommand& v = command.velocity;
  return v.vx != 0 || v.vy != 0 || v.yaw_rate != 0;
}

}  // namespace

bool Suspicion::is_unstated(const std::string& field) const {
  return std::find(unstated.begin(), unstated.end(), field) != unstated.end();
}

bool Suspicion::is_suspect(const std::string& field) const {
  return std::any_of(suspects.begin(), suspects.end(),
                     [&](const std::string& beginning) { return field.starts_with(beginning); });
}

Search::Search(const LoadedEnv& environment, const RelabelledPolicy& policy, const Suspicion& suspicion,
               std::size_t workers, std::uint64_t seed, double minutes)
    : environment_(environment),
      policy_(policy),
      suspicion_(suspicion),
      seed_(seed),
      pool_(workers),
      base_(with_joints_resolved(*EnvModel::make(environment))) {
  whole_ = {walk_commands(environment.config), kSeeds, kWholeSeconds, 0};
  once_ = {whole_.commands, 1, kWholeSeconds, 0};
  // A group of pairs and walking its best whole take the rest.
  constexpr double kShare = 0.75, kSecondsPerMinute = 60;
  using Clock = std::chrono::steady_clock;
  late_ = minutes > 0
              ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(kShare * kSecondsPerMinute * minutes))
              : Clock::time_point::max();
  glance_ = {{whole_.commands.front()}, 1, kGlanceSeconds, 0};
}

bool Search::is_late() noexcept {
  cut_short_ = cut_short_ || std::chrono::steady_clock::now() > late_;
  return cut_short_;
}

WalkResult Search::examine() {
  ++configurations_;
  WalkResult result;
  std::vector<WalkResult> parts(whole_.commands.size());
  bool walks_as_asked = true;
  pool_.run(parts.size(), [&](std::size_t c) {
    parts[c] =
        run_walks(environment_.with(base_), policy_, {{whole_.commands[c]}, kSeeds, kWholeSeconds, 0}, seed_);
  });
  for (std::size_t c = 0; c < parts.size(); ++c)
    walks_as_asked = walks_as_asked && (!moves(whole_.commands[c]) || does_what_is_asked(parts[c], kSeeds));
  double worst = 0;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    for (std::size_t k = 0; k < kSeeds; ++k) {
      // Whatever keeps a robot from moving makes it stand well: that says nothing as long as it has to walk.
      const bool tells = walks_as_asked || moves(whole_.commands[c]);
      if (!tells || parts[c].scores[k] <= worst) continue;
      worst = parts[c].scores[k];
      glance_.commands = {whole_.commands[c]};
      glance_.first = once_.first = k;
    }
    result.walks.insert(result.walks.end(), parts[c].walks.begin(), parts[c].walks.end());
    result.scores.insert(result.scores.end(), parts[c].scores.begin(), parts[c].scores.end());
  }
  return result;
}

std::vector<Candidate> Search::changes(const Candidate* before) const {
  const EnvConfig& from = before == nullptr ? base_ : before->config;
  const auto model = EnvModel::make(environment_.with(from));
  const FieldContext context{*model, from, servo_places(*model->world.robot)};
  const std::string as_it_is = to_yaml(from);
  std::vector<Candidate> candidates;
  for (const FieldRow& row : field_rows()) {
    for (const CandidateField& field : row.fields(context)) {
      if (before != nullptr && std::count(before->fields.begin(), before->fields.end(), field.name) > 0)
        continue;
      const bool unstated = suspicion_.is_unstated(field.name);
      for (const FieldChange& change : field.changes) {
        Candidate one{field.name,
                      field.from,
                      change.to,
                      {field.name},
                      row.physics,
                      unstated,
                      suspicion_.is_suspect(field.name),
                      change,
                      from,
                      from,
                      {},
                      {},
                      {}};
        if (before != nullptr) {
          one.field = before->field + kAnd + one.field;
          one.from = before->from + kAnd + one.from;
          one.to = before->to + kAnd + one.to;
          one.fields = before->fields;
          one.fields.push_back(field.name);
          one.physics = one.physics || before->physics;
          one.unstated = one.unstated && before->unstated;
          one.suspect = one.suspect && before->suspect;
        }
        change.apply(one.config);
        if (to_yaml(one.config) != as_it_is) candidates.push_back(std::move(one));
      }
    }
  }
  return candidates;
}

Candidate Search::in_strength(const Candidate& candidate, double strength) {
  return with_change(candidate, candidate.change.in_strength(strength));
}

Candidate Search::with_change(const Candidate& candidate, const FieldChange& change) {
  Candidate other = candidate;
  other.change = change;
  const std::size_t last = candidate.to.rfind(kAnd);  // of two, the second
  other.to =
      last == std::string::npos ? other.change.to : candidate.to.substr(0, last) + kAnd + other.change.to;
  other.config = candidate.before;
  other.change.apply(other.config);
  other.glance = other.once = other.whole = std::nullopt;
  return other;
}

void Search::glance(std::vector<Candidate>& candidates, const Progress& progress) {
  run(candidates, glance_, &Candidate::glance, progress);
}
void Search::once(std::vector<Candidate>& candidates, const Progress& progress) {
  run(candidates, once_, &Candidate::once, progress);
}
void Search::whole(std::vector<Candidate>& candidates, const Progress& progress) {
  run(candidates, whole_, &Candidate::whole, progress);
}

void Search::run(std::vector<Candidate>& candidates, const WalkTest& test,
                 std::optional<WalkResult> Candidate::*result, const Progress& progress) {
  SharedProgress shared(progress, candidates.size());
  pool_.run(candidates.size(), [&](std::size_t i) {
    Candidate& candidate = candidates[i];
    if (candidate.*result || shared.interrupted()) return;
    try {
      candidate.*result = run_walks(environment_.with(candidate.config), policy_, test, seed_);
    } catch (const ConfigError&) {
      candidate.*result = std::nullopt;  // no environment can be that
    }
    shared.part_done();
  });
  if (shared.interrupted()) throw Interrupted();
  configurations_ += candidates.size();
  std::erase_if(candidates, [result](const Candidate& c) { return !(c.*result); });
}

std::vector<Candidate> best_of_fields(std::vector<Candidate> candidates,
                                      std::optional<WalkResult> Candidate::*result, std::size_t each,
                                      std::size_t most) {
  std::stable_sort(candidates.begin(), candidates.end(), [result](const Candidate& a, const Candidate& b) {
    return (a.*result)->mean() < (b.*result)->mean();
  });
  std::vector<Candidate> best;
  std::map<std::string, std::size_t> taken;
  for (Candidate& candidate : candidates) {
    const std::size_t of_field = taken[candidate.field]++;
    const bool looked_at = (candidate.suspect || candidate.unstated) && of_field == 0;
    if (looked_at || (best.size() < most && of_field < each)) best.push_back(std::move(candidate));
  }
  return best;
}

std::size_t put_needless_pairs_last(std::vector<Candidate>& ranked, std::size_t rivals) {
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(rivals);
  std::set<std::string> alone;
  for (auto one = ranked.begin(); one != end; ++one) {
    if (one->fields.size() == 1) alone.insert(one->fields.front());
  }
  const auto needless = std::stable_partition(ranked.begin(), end, [&alone](const Candidate& candidate) {
    return candidate.fields.size() == 1 ||
           std::ranges::none_of(candidate.fields,
                                [&alone](const std::string& field) { return alone.contains(field); });
  });
  return static_cast<std::size_t>(needless - ranked.begin());
}

}  // namespace crossgait
