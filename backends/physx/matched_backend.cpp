#include "backends/physx/matched_backend.h"

#include "backends/contact/tree_backend.h"
#include "backends/physx/tree_model.h"
#include "backends/physx/version.h"
#include "physics/engine/lost_engine.h"

namespace crossgait::physx {
namespace {

constexpr double kNoBound = 100;  // m/s: the most that a world may ask for, and more than any foot has

class MatchedBackend final : public contact::TreeBackend, public LosableWorld {
 public:
  MatchedBackend(const WorldSpec& world, const EngineInfo& info, const contact::LawFactors& factors,
                 std::optional<double> margin)
      : TreeBackend(
            world, info, factors, [](const WorldSpec& spec) { return std::make_unique<TreeModel>(spec); },
            margin) {}

  void throw_if_lost() const override { refuse_fork(); }

 protected:
  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    return is_fork() ? StepStatus::kDiverged : TreeBackend::do_step(tau, base);
  }
};

EngineInfo info_of(const std::string& name, const contact::LawFactors& factors) {
  EngineInfo info;
  info.name = name;
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
  const bool matched = base == law_table().off;
  // What is added to the hard end leads on to PhysX's own contact (settings.h).
  if (!matched && (base != law_table().on || changes.starts_with('+'))) return std::nullopt;
  const contact::LawFactors factors =
      law_table().changed(matched ? contact::LawFactors{} : contact::kHardLaw, changes, name);
  const EngineInfo info = info_of(law_table().name_of(factors), factors);
  return Engine{info, [info, factors](const WorldSpec& spec) {
                  return std::make_unique<MatchedBackend>(spec, info, factors, std::nullopt);
                }};
}

Engine shared_engine(const Settings& settings) {
  EngineInfo info = info_of(settings.name, contact::kHardLaw);
  info.laws.contact += split_factors(settings.name).second;
  if (settings.push_out) info.capabilities.error_reduction = false;
  const std::optional<double> margin =
      settings.margin ? std::optional(settings.contact_offset) : std::nullopt;
  return {info, [info, margin, settings](WorldSpec spec) {
            if (settings.push_out) {
              spec.contact.erp = kPushOut;
              spec.contact.max_depenetration_velocity = kNoBound;
              spec.contact.cfm = 0;
            }
            return std::make_unique<MatchedBackend>(spec, info, contact::kHardLaw, margin);
          }};
}

EngineFamily law_family() { return contact::family_of(law_table(), find_matched); }

}  // namespace crossgait::physx
