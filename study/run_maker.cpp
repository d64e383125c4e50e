#include "study/run_maker.h"

#include "backends/registry.h"
#include "study/run_store.h"

namespace crossgait {

RunMaker::RunMaker(BehaviourSpec spec) : spec_(std::move(spec)), described_(to_json(spec_)) {}

const Behaviour& RunMaker::behaviour() const {
  const std::scoped_lock lock(mutex_);
  if (!behaviour_) behaviour_ = std::make_unique<const Behaviour>(make_behaviour(spec_));
  return *behaviour_;
}

nlohmann::json RunMaker::describe(const std::string& engine, const Variation& variation,
                                  std::size_t start) const {
  const EngineInfo info = find_engine(engine).info;
  return to_json(RunSpec{spec_, info.name, info.version, variation, start}, described_);
}

bool RunMaker::allows(const Variation& variation) const { return behaviour().allows(variation); }

std::string RunMaker::make(const std::string& engine, const Variation& variation, std::size_t start) const {
  RunResult result;
  for (const Statistic& s : behaviour().statistics) result.names.push_back(s.name);
  result.values = behaviour().run(find_engine(engine), variation, start);
  return stored_run(describe(engine, variation, start), result);
}

}  // namespace crossgait
