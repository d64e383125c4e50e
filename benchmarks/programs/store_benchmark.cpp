// What a store of many runs costs: to be read once and indexed, to be opened again, and to find a run in.
//   build/release/benchmarks/programs/store_benchmark FOLDER [RUNS]
// Makes FOLDER/runs.jsonl of so many runs (1,000,000: 2 GB) unless it is there.
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "study/run_store.h"

namespace {

using namespace crossgait;

/// Seconds of the processor since `begin`, which other programs on the machine do not change.
double since(std::clock_t begin) { return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC; }

long peak_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// A run as a verdict describes it, told from others by its start.
class Runs {
 public:
  Runs() : described_(LoadedBehaviour(BehaviourSpec{WalkConfig{}, {}, 0}).described) {
    engine_.name = "mujoco";
    engine_.version = "2.2.2";
    for (int i = 0; i < 30; ++i) {
      result_.keys.push_back(fmt::format("statistic {}", i));
      result_.run.values.emplace_back(0.1 + i);
    }
  }
  nlohmann::json run(std::size_t start) const { return describe_run(described_, engine_, {}, start); }
  const RunResult& result() const { return result_; }

 private:
  nlohmann::json described_;
  EngineInfo engine_;
  RunResult result_;
};

void make(const std::string& path, const Runs& runs, std::size_t count) {
  std::ofstream out(path);
  for (std::size_t start = 0; start < count; ++start)
    out << stored_run(runs.run(start), runs.result()) << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

void measure(const std::string& folder, std::size_t count) {
  const std::string path = folder + "/runs.jsonl";
  const Runs runs;
  if (!std::filesystem::exists(path)) make(path, runs, count);
  fmt::print("{} bytes\n", std::filesystem::file_size(path));
  for (const bool anew : {true, false}) {
    if (anew) std::filesystem::remove(path + ".index");
    const std::clock_t begin = std::clock();
    RunStore store(path);
    fmt::print("{} runs, {}: opened in {:.2f} s, {} MB at most\n", store.size(),
               anew ? "read anew" : "by the index", since(begin), peak_mb());
    constexpr std::size_t kFinds = 1000;
    const std::clock_t finding = std::clock();
    for (std::size_t i = 0; i < kFinds; ++i) {
      if (!store.find(runs.run(i * 7919 % count))) throw std::runtime_error("a run is not found");
    }
    fmt::print("a run is found in {:.3f} ms\n", since(finding));
  }
}

}  // namespace

int main(int argc, char** argv) {
  constexpr std::size_t kRuns = 1'000'000;
  try {
    if (argc < 2) throw std::runtime_error("expected a folder");
    measure(argv[1], argc > 2 ? std::stoul(argv[2]) : kRuns);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    fmt::print(stderr, "store_benchmark: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
