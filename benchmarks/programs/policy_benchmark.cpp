// What a policy costs per action, for an environment with four parameters and no terrain (69 observations, 16
// actions). p50_us and p99_us are percentiles over single actions.
#include <algorithm>
#include <chrono>
#include <filesystem>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "tests/policy/policy_interfaces.h"

namespace crossgait {
namespace {

using policy_tests::large_interface;
using policy_tests::random_network;

std::unique_ptr<Policy> load(const MlpNetwork& network) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("crossgait-policy-benchmark-" + std::to_string(::getpid()) + ".safetensors");
  write_policy_bundle(file, network, large_interface());
  auto policy = make_policy(file, large_interface());
  std::filesystem::remove(file);
  return policy;
}

void measure(benchmark::State& state, Policy& policy) {
  Random random;
  const PolicyInterface& interface = policy.interface();
  std::vector<double> observation(interface.observation.size()), action(interface.action.size()), times;
  times.reserve(1 << 20);
  for (double& value : observation) value = random.uniform(-2, 2);
  using Clock = std::chrono::steady_clock;
  for (auto _ : state) {
    observation[0] = random.uniform(-2, 2);
    const Clock::time_point begin = Clock::now();
    policy.act(observation, action);
    benchmark::DoNotOptimize(action.data());
    if (times.size() < times.capacity())
      times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  std::sort(times.begin(), times.end());
  state.counters["p50_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
}

void BM_Mlp512x256x128(benchmark::State& state, MlpActivation activation) {
  MlpNetwork network = random_network(large_interface(), {512, 256, 128});
  network.activation = activation;
  measure(state, *load(network));
}
BENCHMARK_CAPTURE(BM_Mlp512x256x128, tanh, MlpActivation::kTanh);
BENCHMARK_CAPTURE(BM_Mlp512x256x128, elu, MlpActivation::kElu);
BENCHMARK_CAPTURE(BM_Mlp512x256x128, relu, MlpActivation::kRelu);

void BM_Mlp64x64(benchmark::State& state) {
  measure(state, *load(random_network(large_interface(), {64, 64})));
}
BENCHMARK(BM_Mlp64x64);

void BM_RandomPolicy(benchmark::State& state) { measure(state, *make_policy("random", large_interface())); }
BENCHMARK(BM_RandomPolicy);

}  // namespace
}  // namespace crossgait
