#include "study/run_maker.h"

#include "backends/registry.h"
#include "study/run_store.h"

namespace crossgait {

RunMaker::RunMaker(LoadedBehaviour loaded) : loaded_(std::move(loaded)) {}

const Behaviour& RunMaker::behaviour() const {
  const std::scoped_lock lock(mutex_);
  if (!behaviour_) behaviour_ = std::make_unique<const Behaviour>(make_behaviour(loaded_));
  return *behaviour_;
}

nlohmann::json RunMaker::describe(const std::string& engine, const Variation& variation,
                                  std::size_t start) const {
  return describe_run(loaded_.described, find_engine(engine).info, variation, start);
}

bool RunMaker::allows(const std::string& engine, const Variation& variation) const {
  return variation.of(find_engine(engine).info) && behaviour().allows(variation);
}

std::string RunMaker::make(const std::string& engine, const Variation& variation, std::size_t start) const {
  return stored_run(describe(engine, variation, start),
                    run(behaviour(), find_engine(engine), variation, start));
}

}  // namespace crossgait
