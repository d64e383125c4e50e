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

std::vector<std::string> backend_names(const ordered_json& result) {
  std::vector<std::string> names;
  for (const ordered_json& backend : result.at("backends")) names.push_back(backend.at("name"));
  return names;
}

/// Records side by side: rows in the order in which their labels first appear, a column per engine.
class Columns {
 public:
  Columns(std::string heading, std::vector<std::string> backends)
      : heading_(std::move(heading)), backends_(std::move(backends)) {}

  void set(const std::string& label, const std::string& backend, std::string cell) {
    std::vector<std::string>* row = nullptr;
    for (auto& [name, cells] : rows_) {
      if (name == label) row = &cells;
    }
    if (row == nullptr) row = &rows_.emplace_back(label, std::vector<std::string>(backends_.size())).second;
    for (std::size_t i = 0; i < backends_.size(); ++i) {
      if (backends_[i] != backend) continue;
      (*row)[i] = std::move(cell);
      return;
    }
  }

  std::string str() const {
    std::vector<std::string> header{heading_};
    header.insert(header.end(), backends_.begin(), backends_.end());
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
  std::vector<std::string> backends_;
  std::vector<std::pair<std::string, std::vector<std::string>>> rows_;
};

std::string speed_tables(const ordered_json& speed, const std::vector<std::string>& backends) {
  Columns time("us per physics step (1 ms)", backends), ratio("ratio to " + backends[0], backends),
      rate("steps per core-second", backends), real("real-time factor", backends),
      contacts("contacts per step", backends), scaling("threads, 1000 steps/s", backends),
      eta("walk stack", backends);
  for (const ordered_json& r : speed.at("scenes")) {
    const std::string scene = r.at("scene"), backend = r.at("backend");
    const auto quartiles = [&r](const char* key) { return r.at(key).get<std::array<double, 2>>(); };
    const auto us = quartiles("us_per_step_quartiles"), of = quartiles("ratio_quartiles");
    time.set(scene, backend,
             fmt::format("{:.2f} ({:.2f} to {:.2f})", number(r, "us_per_step"), us[0], us[1]));
    ratio.set(scene, backend, fmt::format("{:.3f} ({:.3f} to {:.3f})", number(r, "ratio"), of[0], of[1]));
    rate.set(scene, backend, fmt::format("{:.0f}", number(r, "steps_per_core_second")));
    real.set(scene, backend, fmt::format("{:.1f}", number(r, "real_time_factor")));
    contacts.set(scene, backend, fmt::format("{:.2f}", number(r, "contacts")));
  }
  for (const ordered_json& r : speed.at("eta")) {
    const std::string terrain = r.at("terrain"), backend = r.at("backend");
    eta.set("eta, trot on " + terrain, backend, fmt::format("{:.3f}", number(r, "eta")));
    eta.set("us per step, walk on " + terrain, backend, fmt::format("{:.2f}", number(r, "walk_us_per_step")));
    eta.set("us per step, engine alone", backend, fmt::format("{:.2f}", number(r, "engine_us_per_step")));
  }
  for (const ordered_json& r : speed.at("threads")) {
    scaling.set(fmt::format("{}", r.at("threads").get<int>()), r.at("backend"),
                fmt::format("{:.1f} ({:.0f} %)", 1e-3 * number(r, "steps_per_second"),
                            100 * number(r, "efficiency")));
  }
  return time.str() + ratio.str() + rate.str() + real.str() + contacts.str() + eta.str() + scaling.str();
}

std::string accuracy_tables(const ordered_json& accuracy, const std::vector<std::string>& backends) {
  Columns position("RMS error of the base, um", backends), joints("RMS error of the joints, mrad", backends),
      cost("CPU seconds per simulated second", backends), stable("largest stable step, ms", backends);
  for (const ordered_json& p : accuracy.at("points")) {
    const std::string backend = p.at("backend");
    const std::string label =
        fmt::format("{}, {:g} ms", p.at("terrain").get<std::string>(), 1e3 * number(p, "step_s"));
    const auto error = [&p](const char* key, double unit) {
      return p.at(key).is_null() ? std::string("diverged") : fmt::format("{:.3g}", unit * number(p, key));
    };
    position.set(label, backend, error("position_error_m", 1e6));
    joints.set(label, backend, error("joint_error_rad", 1e3));
    cost.set(label, backend, fmt::format("{:.4f}", number(p, "cost")));
  }
  for (const ordered_json& s : accuracy.at("stable_steps")) {
    const ordered_json& largest = s.at("largest_s");
    const std::string cell =
        largest.is_null() ? std::string("none") : fmt::format("{:.3g}", 1e3 * largest.get<double>());
    stable.set(s.at("terrain"), s.at("backend"), cell);
  }
  return position.str() + joints.str() + cost.str() + stable.str();
}

std::string analytic_tables(const ordered_json& analytic, const std::vector<std::string>& backends) {
  Columns errors("error at 1 ms", backends), orders("order of convergence", backends),
      friction("friction", backends);
  for (const ordered_json& c : analytic.at("convergence")) {
    const std::string quantity = c.at("quantity"), backend = c.at("backend"), unit = c.at("unit");
    for (std::size_t i = 0; i < c.at("step_s").size(); ++i) {
      if (std::abs(c.at("step_s").at(i).get<double>() - 1e-3) > 1e-9) continue;
      errors.set(fmt::format("{}, {}", quantity, unit), backend,
                 fmt::format("{:.3e}", c.at("error").at(i).get<double>()));
    }
    const ordered_json& order = c.at("order");
    orders.set(quantity, backend,
               order.is_null() ? std::string("-") : fmt::format("{:.3f}", order.get<double>()));
  }
  for (const ordered_json& f : analytic.at("friction")) {
    const std::string ground = f.at("ground"), backend = f.at("backend");
    friction.set(ground + ": creep inside the cone, um/s", backend,
                 fmt::format("{:.3g}", 1e6 * number(f, "creep_inside_mps")));
    friction.set(ground + ": distance outside, error in %", backend,
                 fmt::format("{:.3f}", 100 * number(f, "distance_error_outside")));
    friction.set(ground + ": range over headings, %", backend,
                 fmt::format("{:.3f}", 100 * number(f, "range_over_headings")));
  }
  return errors.str() + orders.str() + friction.str();
}

std::string feet_table(const ordered_json& feet, const std::vector<std::string>& backends) {
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
                                      {"drag of a swinging foot per stride, mm", "drag_per_stride_m", 1e3},
                                      {"deepest penetration, um", "deepest_penetration_m", 1e6}}};
  Columns card("feet", backends);
  for (const ordered_json& c : feet) {
    for (const Row& row : kRows) {
      card.set(fmt::format("{}: {}", c.at("terrain").get<std::string>(), row.label), c.at("backend"),
               fmt::format("{:.4g}", row.unit * number(c, row.key)));
    }
  }
  return card.str();
}

}  // namespace

std::string describe_bench(const ordered_json& result) {
  const std::vector<std::string> backends = backend_names(result);
  const ordered_json& m = result.at("machine");
  std::string text = fmt::format("{}, {} cores, {}, {}; {}{}\n\n", m.value("processor", "unknown processor"),
                                 m.value("cores", 0), m.value("operating_system", "unknown system"),
                                 m.value("compiler", "unknown compiler"), m.value("date", "no date"),
                                 result.value("quick", false) ? "; quick" : "");
  if (result.contains("speed")) text += speed_tables(result.at("speed"), backends);
  if (result.contains("accuracy")) text += accuracy_tables(result.at("accuracy"), backends);
  if (result.contains("analytic")) text += analytic_tables(result.at("analytic"), backends);
  if (result.contains("feet")) text += feet_table(result.at("feet"), backends);
  return text;
}

}  // namespace crossgait::benchmarks
