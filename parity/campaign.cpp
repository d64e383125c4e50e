#include "parity/campaign.h"

#include <algorithm>

#include "physics/core/worker_pool.h"

namespace crossgait {

const BehaviourRun* Campaign::find(const Key& key) {
  const auto whole = runs_.find({key.engine, key.variation, key.start});
  if (whole != runs_.end()) {
    const double end = whole->second.seconds - kStepRounding * behaviour_.cut_dt;
    if (key.cuts == 0 || end <= seconds(key.cuts)) return &whole->second;
  }
  const auto cut = runs_.find(key);
  if (cut != runs_.end()) return &cut->second;
  missing_.insert(key);
  return nullptr;
}

void Campaign::make_missing(const Progress& progress) {
  const std::vector<Key> keys(missing_.begin(), missing_.end());
  std::vector<BehaviourRun> made(keys.size());
  SharedProgress shared(progress, keys.size());
  WorkerPool pool(std::min(workers_, keys.size()));
  pool.run(keys.size(), [&](std::size_t i) {
    if (shared.interrupted()) return;
    const Key& key = keys[i];
    made[i] = behaviour_.run(engines_[key.engine], variations()[key.variation], key.start, seconds(key.cuts));
    shared.part_done();
  });
  if (shared.interrupted()) throw Interrupted();
  for (std::size_t i = 0; i < keys.size(); ++i) runs_.emplace(keys[i], std::move(made[i]));
  missing_.clear();
}

std::size_t Campaign::first_end(std::span<const BehaviourRun* const> runs) const {
  double first = behaviour_.seconds;
  bool early = false;
  for (const BehaviourRun* run : runs) {
    early = early || ended_early(*run);
    first = std::min(first, run->seconds);
  }
  return early ? std::max<std::size_t>(1, static_cast<std::size_t>(first / behaviour_.cut_dt + kStepRounding))
               : 0;
}

bool Campaign::ended_early(const BehaviourRun& run) const {
  return run.seconds < behaviour_.seconds - kStepRounding * behaviour_.cut_dt;
}

double Campaign::seconds(std::size_t cuts) const {
  return cuts == 0 ? kToTheEnd : static_cast<double>(cuts) * behaviour_.cut_dt;
}

}  // namespace crossgait
