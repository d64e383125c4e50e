#include "backends/bullet/contact_factors.h"

namespace crossgait::bullet {

const contact::FactorTable<ContactFactors>& factor_table() {
  static const contact::FactorTable<ContactFactors> kTable = [] {
    contact::FactorTable<ContactFactors> table{"bullet:matched", "bullet", {}};
    table.rows.push_back({{"narrowphase", "contact points found by Bullet's collision detection", {}},
                          &ContactFactors::narrowphase});
    for (const auto& [factor, member] : contact::law_factor_rows()) table.rows.push_back({factor, member});
    // Bullet's sweeps are over rows of all its other factors.
    ModelFactor sweeps{
        "sweeps", "as many sweeps as Bullet makes, in its order, not a converged solution", {}};
    for (const auto& [factor, member] : table.rows) sweeps.needs.push_back(factor.name);
    table.rows.push_back({sweeps, &ContactFactors::sweeps});
    return table;
  }();
  return kTable;
}

}  // namespace crossgait::bullet
