#include "backends/physx/matched_backend.h"

#include "backends/contact/tree_backend.h"
#include "backends/physx/tree_model.h"
#include "backends/physx/version.h"
#include "physics/engine/lost_engine.h"

namespace crossgait::physx {
namespace {

class MatchedBackend final : public contact::TreeBackend, public LosableWorld {
 public:
  MatchedBackend(const WorldSpec& world, const EngineInfo& info, const contact::LawFactors& factors)
      : TreeBackend(world, info, factors,
                    [](const WorldSpec& spec) { return std::make_unique<TreeModel>(spec); }) {}

  void throw_if_lost() const override { refuse_fork(); }

 protected:
  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    return is_fork() ? StepStatus::kDiverged : TreeBackend::do_step(tau, base);
  }
};

EngineInfo law_info(const contact::LawFactors& factors) {
  EngineInfo info;
  info.name = law_table().name_of(factors);
  info.library = "PhysX";
  info.version = version();
  info.capabilities.allocates = true;
  info.capabilities.precision = Precision::kFloat32;
  contact::describe_law(factors, info.library, info);
  return info;
}

}  // namespace

const contact::FactorTable<contact::LawFactors>& law_table() {
  static const contact::FactorTable<contact::LawFactors> kTable{"physx:matched", "physx:hard",
                                                                contact::law_factor_rows()};
  return kTable;
}

std::optional<Engine> find_matched(std::string_view name) {
  const auto [base, changes] = split_factors(name);
  if (base != law_table().off && base != law_table().on) return std::nullopt;
  const contact::LawFactors end = base == law_table().on ? contact::kHardLaw : contact::LawFactors{};
  const contact::LawFactors factors = law_table().changed(end, changes, name);
  const EngineInfo info = law_info(factors);
  return Engine{info, [info, factors](const WorldSpec& spec) {
                  return std::make_unique<MatchedBackend>(spec, info, factors);
                }};
}

EngineFamily law_family() { return contact::family_of(law_table(), find_matched); }

}  // namespace crossgait::physx
