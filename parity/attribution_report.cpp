#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "parity/verdict_report.h"
#include "physics/core/table.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

std::string when(const Attribution& a, const std::optional<FirstDivergence>& first) {
  if (!a.has_traces) return "-";
  return first ? fmt::format("{} at {:.3f} s", first->quantity, first->time_s) : "nothing";
}

// Statistics whose gap somebody would act on.
std::vector<std::size_t> worth_explaining(const Attribution& a) {
  std::vector<std::size_t> shown;
  for (std::size_t s = 0; s < a.statistics.size(); ++s) {
    if (std::abs(a.gap[s].estimate) >= a.margin[s]) shown.push_back(s);
  }
  return shown;
}

std::string effects_table(const Attribution& a, const std::vector<std::size_t>& shown) {
  std::vector<std::string> header{"part of the gap"};
  for (const std::size_t s : shown) header.push_back(label(a.statistics[s]));
  header.emplace_back("first to part");
  Table table(header);
  for (const GroupEffect& group : a.groups) {
    const auto effects = [&](const std::string& name, const std::vector<Interval>& effect,
                             const std::string& last) {
      std::vector<std::string> row{name};
      for (const std::size_t s : shown)
        row.push_back(fmt::format("{:+.3g} ± {:.2g}", effect[s].estimate, effect[s].half_width()));
      row.push_back(last);
      table.add_row(row);
    };
    const bool one = group.factors.size() == 1;
    const FactorEffect& first = a.effects[group.factors.front()];
    effects(group.name, group.effect, one ? when(a, first.first_divergence) : "");
    for (const std::size_t i : group.factors) {
      const FactorEffect& e = a.effects[i];
      if (!one) effects(fmt::format("  of which {}", e.factor.name), e.effect, when(a, e.first_divergence));
    }
  }
  return table.str();
}

std::string way_table(const Attribution& a) {
  std::vector<std::string> header{"one after the other"};
  for (const Statistic& s : a.statistics) header.push_back(label(s));
  Table table(header);
  std::vector<double> now = a.from_mean;
  const auto add = [&](const std::string& name) {
    std::vector<std::string> row{name};
    for (const double value : now) row.push_back(fmt::format("{:.4g}", value));
    table.add_row(row);
  };
  add(a.from);
  for (const FactorEffect& e : a.effects) {
    for (std::size_t s = 0; s < now.size(); ++s) now[s] += e.step[s].estimate;
    add(fmt::format("+ {}", e.factor.name));
  }
  return table.str() + fmt::format("The last line is {}.\n", a.to);
}

}  // namespace

nlohmann::ordered_json to_json(const Attribution& a) {
  ordered_json json{{"behaviour", a.behaviour}, {"from", a.from}, {"to", a.to}, {"starts", a.starts}};
  for (std::size_t s = 0; s < a.statistics.size(); ++s) {
    ordered_json statistic{{"key", a.statistics[s].key},   {"name", a.statistics[s].name},
                           {"unit", a.statistics[s].unit}, {"mean_from", a.from_mean[s]},
                           {"mean_to", a.to_mean[s]},      {"gap", to_json(a.gap[s])},
                           {"margin", a.margin[s]}};
    const Cause cause = a.cause(s);
    constexpr std::array kKinds{"nothing", "leading", "no single cause"};
    statistic["cause"] = {{"kind", kKinds[static_cast<std::size_t>(cause.kind)]},
                          {"leading", cause.leading},
                          {"sentence", cause.sentence}};
    if (const auto& i = a.interactions[s])
      statistic["interaction"] = {{"groups", {i->first, i->second}}, {"amount", i->amount}};
    else
      statistic["interaction"] = nullptr;
    for (const FactorEffect& e : a.effects) {
      statistic["factors"].push_back({{"name", e.factor.name},
                                      {"effect", to_json(e.effect[s])},
                                      {"first", to_json(e.first[s])},
                                      {"last", to_json(e.last[s])},
                                      {"step", to_json(e.step[s])}});
    }
    for (const GroupEffect& g : a.groups)
      statistic["groups"].push_back({{"name", g.name}, {"effect", to_json(g.effect[s])}});
    json["statistics"].push_back(statistic);
  }
  for (const FactorEffect& e : a.effects) {
    ordered_json first = nullptr;
    if (const auto& d = e.first_divergence)
      first = {{"quantity", d->quantity}, {"time_s", d->time_s}, {"tolerance", d->tolerance}};
    json["factors"].push_back({{"name", e.factor.name},
                               {"summary", e.factor.summary},
                               {"needs", e.factor.needs},
                               {"group", group_of(e.factor)},
                               {"first_divergence", first}});
  }
  return json;
}

std::string describe(const Attribution& a) {
  const std::vector<std::size_t> shown = worth_explaining(a);
  std::string text = fmt::format("From {} to {}, {} starts:\n\n", a.from, a.to, a.starts);
  for (const FactorEffect& e : a.effects)
    text += fmt::format("  {:19} {}\n", e.factor.name, e.factor.summary);
  text += fmt::format("\n{}\n", way_table(a));
  if (shown.empty()) return text.append("No gap is large enough to explain.\n");
  text += effects_table(a, shown) + "\n";
  for (const std::size_t s : shown) {
    const std::string sentence = a.cause(s).sentence;
    text +=
        fmt::format("{}: {}.\n", a.statistics[s].name, sentence.empty() ? "no cause can be told" : sentence);
  }
  return text;
}

}  // namespace crossgait
