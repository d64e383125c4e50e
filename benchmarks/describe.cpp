// Results of the benchmark as tables: one row per thing measured, one column per engine.
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "benchmarks/bench.h"
#include "physics/core/table.h"

namespace crossgait::benchmarks {
namespace {

using nlohmann::ordered_json;

double number(const ordered_json& record, const char* key) { return record.at(key).get<double>(); }

std::vector<std::string> engine_names(const ordered_json& result) {
  std::vector<std::string> names;
  for (const ordered_json& engine : result.at("engines")) names.push_back(engine.at("name"));
  return names;
}

/// Records side by side: rows in the order in which their labels first appear, a column per engine.
class Columns {
 public:
  Columns(std::string heading, std::vector<std::string> engines)
      : heading_(std::move(heading)), engines_(std::move(engines)) {}

  void set(const std::string& label, const std::string& engine, std::string cell) {
    std::vector<std::string>* row = nullptr;
    for (auto& [name, cells] : rows_) {
      if (name == label) row = &cells;
    }
    if (row == nullptr) row = &rows_.emplace_back(label, std::vector<std::string>(engines_.size())).second;
    for (std::size_t i = 0; i < engines_.size(); ++i) {
      if (engines_[i] != engine) continue;
      (*row)[i] = std::move(cell);
      return;
    }
  }

  std::string str() const {
    std::vector<std::string> header{heading_};
    header.insert(header.end(), engines_.begin(), engines_.end());
    Table table(std::move(header));
    for (const auto& [name, cells] : rows_) {
      std::vector<std::string> row{name};
      row.insert(row.end(), cells.begin(), cells.end());
      table.add_row(std::move(row));
    }
    return table.str() + "\n";
  }

 private:
  std::string heading_;
  std::vector<std::string> engines_;
  std::vector<std::pair<std::string, std::vector<std::string>>> rows_;
};

std::string speed_tables(const ordered_json& speed, const std::vector<std::string>& engines) {
  Columns time("us per physics step (1 ms)", engines), ratio("ratio to " + engines[0], engines),
      rate("steps per core-second", engines), real("real-time factor", engines),
      contacts("contacts per step", engines), scaling("threads, 1000 steps/s", engines),
      eta("walk stack", engines);
  for (const ordered_json& r : speed.at("scenes")) {
    const std::string scene = r.at("scene"), engine = r.at("engine");
    const auto quartiles = [&r](const char* key) { return r.at(key).get<std::array<double, 2>>(); };
    const auto us = quartiles("us_per_step_quartiles"), of = quartiles("ratio_quartiles");
    time.set(scene, engine, fmt::format("{:.2f} ({:.2f} to {:.2f})", number(r, "us_per_step"), us[0], us[1]));
    ratio.set(scene, engine, fmt::format("{:.3f} ({:.3f} to {:.3f})", number(r, "ratio"), of[0], of[1]));
    rate.set(scene, engine, fmt::format("{:.0f}", number(r, "steps_per_core_second")));
    real.set(scene, engine, fmt::format("{:.1f}", number(r, "real_time_factor")));
    contacts.set(scene, engine, fmt::format("{:.2f}", number(r, "contacts")));
  }
  for (const ordered_json& r : speed.at("eta")) {
    const std::string terrain = r.at("terrain"), engine = r.at("engine");
    eta.set("eta, trot on " + terrain, engine, fmt::format("{:.3f}", number(r, "eta")));
    eta.set("us per step, walk on " + terrain, engine, fmt::format("{:.2f}", number(r, "walk_us_per_step")));
    eta.set("us per step, engine alone", engine, fmt::format("{:.2f}", number(r, "engine_us_per_step")));
  }
  for (const ordered_json& r : speed.at("threads")) {
    scaling.set(fmt::format("{}", r.at("threads").get<int>()), r.at("engine"),
                fmt::format("{:.1f} ({:.0f} %)", 1e-3 * number(r, "steps_per_second"),
                            100 * number(r, "efficiency")));
  }
  return time.str() + ratio.str() + rate.str() + real.str() + contacts.str() + eta.str() + scaling.str();
}

std::string accuracy_tables(const ordered_json& accuracy, const std::vector<std::string>& engines) {
  Columns position("RMS error of the base, um", engines), joints("RMS error of the joints, mrad", engines),
      cost("CPU seconds per simulated second", engines), stable("largest stable step, ms", engines);
  for (const ordered_json& p : accuracy.at("points")) {
    const std::string engine = p.at("engine");
    const std::string label =
        fmt::format("{}, {:g} ms", p.at("terrain").get<std::string>(), 1e3 * number(p, "step_s"));
    const auto error = [&p](const char* key, double unit) {
      return p.at(key).is_null() ? std::string("diverged") : fmt::format("{:.3g}", unit * number(p, key));
    };
    position.set(label, engine, error("position_error_m", 1e6));
    joints.set(label, engine, error("joint_error_rad", 1e3));
    cost.set(label, engine, fmt::format("{:.4f}", number(p, "cost")));
  }
  for (const ordered_json& s : accuracy.at("stable_steps")) {
    const ordered_json& largest = s.at("largest_s");
    const std::string cell =
        largest.is_null() ? std::string("none") : fmt::format("{:.3g}", 1e3 * largest.get<double>());
    stable.set(s.at("terrain"), s.at("engine"), cell);
  }
  return position.str() + joints.str() + cost.str() + stable.str();
}

std::string analytic_tables(const ordered_json& analytic, const std::vector<std::string>& engines) {
  Columns errors("error at 1 ms", engines), orders("order of convergence", engines),
      friction("friction", engines), rebound("a ball thrown at the plane leaves with", engines);
  for (const ordered_json& c : analytic.at("convergence")) {
    const std::string quantity = c.at("quantity"), engine = c.at("engine"), unit = c.at("unit");
    for (std::size_t i = 0; i < c.at("step_s").size(); ++i) {
      if (std::abs(c.at("step_s").at(i).get<double>() - 1e-3) > 1e-9) continue;
      errors.set(fmt::format("{}, {}", quantity, unit), engine,
                 fmt::format("{:.3e}", c.at("error").at(i).get<double>()));
    }
    const ordered_json& order = c.at("order");
    orders.set(quantity, engine,
               order.is_null() ? std::string("-") : fmt::format("{:.3f}", order.get<double>()));
  }
  for (const ordered_json& f : analytic.at("friction")) {
    const std::string ground = f.at("ground"), engine = f.at("engine");
    friction.set(ground + ": creep inside the cone, um/s", engine,
                 fmt::format("{:.3g}", 1e6 * number(f, "creep_inside_mps")));
    friction.set(ground + ": distance outside, error in %", engine,
                 fmt::format("{:.3f}", 100 * number(f, "distance_error_outside")));
    friction.set(ground + ": range over headings, %", engine,
                 fmt::format("{:.3f}", 100 * number(f, "range_over_headings")));
  }
  if (analytic.contains("rebound")) {  // a result of before has none
    for (const ordered_json& r : analytic.at("rebound")) {
      rebound.set(fmt::format("share of its speed, steps of {:g} ms", 1e3 * number(r, "step_s")),
                  r.at("engine"), fmt::format("{:.4f}", number(r, "share_of_speed")));
    }
  }
  return errors.str() + orders.str() + friction.str() + rebound.str();
}

std::string feet_table(const ordered_json& feet, const std::vector<std::string>& engines) {
  struct Row {
    const char* label;
    const char* key;
    double unit;
  };
  constexpr std::array<Row, 9> kRows{{{"creep while standing, um/s", "creep_mps", 1e6},
                                      {"penetration while standing, um", "penetration_m", 1e6},
                                      {"force over weight - 1, 1e-6", "force_error", 1e6},
                                      {"touch-downs", "touchdowns", 1},
                                      {"touch-down impulse, mN s", "touchdown_impulse_Ns", 1e3},
                                      {"touch-down peak force over weight", "touchdown_peak_over_weight", 1},
                                      {"slip of a standing foot per stride, mm", "slip_per_stride_m", 1e3},
                                      {"toe drag per stride, mm", "toe_drag_per_stride_m", 1e3},
                                      {"deepest penetration, um", "deepest_penetration_m", 1e6}}};
  Columns card("feet", engines);
  for (const ordered_json& c : feet) {
    for (const Row& row : kRows) {
      card.set(fmt::format("{}: {}", c.at("terrain").get<std::string>(), row.label), c.at("engine"),
               fmt::format("{:.4g}", row.unit * number(c, row.key)));
    }
  }
  return card.str();
}

}  // namespace

std::string describe_bench(const ordered_json& result) {
  const std::vector<std::string> engines = engine_names(result);
  const ordered_json& m = result.at("machine");
  std::string text = fmt::format("{}, {} cores, {}, {}; {}{}\n\n", m.value("processor", "unknown processor"),
                                 m.value("cores", 0), m.value("operating_system", "unknown system"),
                                 m.value("compiler", "unknown compiler"), m.value("date", "no date"),
                                 result.value("quick", false) ? "; quick" : "");
  if (result.contains("speed")) text += speed_tables(result.at("speed"), engines);
  if (result.contains("accuracy")) text += accuracy_tables(result.at("accuracy"), engines);
  if (result.contains("analytic")) text += analytic_tables(result.at("analytic"), engines);
  if (result.contains("feet")) text += feet_table(result.at("feet"), engines);
  return text;
}

}  // namespace crossgait::benchmarks
