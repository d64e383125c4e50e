// Policies that ONNX Runtime computes: what is refused, what is remembered. Networks are written here, byte
// by byte.
#include "policy/onnx_policy.h"

#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "policy/onnx_library.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using policy_tests::small_interface;

// Protocol buffers, as far as ONNX takes them: a field of a number, or of bytes.
std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 128; value /= 128) bytes += static_cast<char>(value % 128 + 128);
  return bytes + static_cast<char>(value);
}
std::string number(int field, std::uint64_t value) { return varint(field * 8U) + varint(value); }
std::string bytes(int field, const std::string& value) {
  return varint(field * 8U + 2) + varint(value.size()) + value;
}

// Source of the fields' numbers: onnx.proto.
std::string value_info(const std::string& name, int size) {
  const std::string shape = bytes(1, number(1, 1)) + bytes(1, number(1, static_cast<std::uint64_t>(size)));
  constexpr int kFloat = 1;
  return bytes(1, name) + bytes(2, bytes(1, number(1, kFloat) + bytes(2, shape)));
}
std::string node(const std::string& operation, const std::vector<std::string>& in, const std::string& out) {
  std::string made;
  for (const std::string& name : in) made += bytes(1, name);
  return made + bytes(2, out) + bytes(4, operation);
}

/// actions = obs + sum_in, and sum_out = actions: the sum of all observations since the episode began.
std::string summing_network(int size = 4) {
  const std::string graph = bytes(1, node("Add", {"obs", "sum_in"}, "actions")) +
                            bytes(1, node("Identity", {"actions"}, "sum_out")) + bytes(2, "sum") +
                            bytes(11, value_info("obs", size)) + bytes(11, value_info("sum_in", size)) +
                            bytes(12, value_info("actions", size)) + bytes(12, value_info("sum_out", size));
  return number(1, 8) + bytes(7, graph) + bytes(8, number(2, 13));
}

std::string description(const std::string& more = "memory: {sum_in: sum_out}\n") {
  const PolicyInterface interface = small_interface();
  return fmt::format(
      "kind: onnx\nlayout_version: {}\nlayout_hash: '{}'\nnetwork: sum.onnx\nobservation: obs\naction: "
      "actions\n{}",
      kLayoutVersion, layout_hash(interface.observation, interface.action), more);
}

class OnnxPolicies : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    write("sum.onnx", summing_network());
  }

  std::unique_ptr<Policy> make(const std::string& text) {
    return make_policy(write("sum.yaml", text), small_interface());
  }
  std::string complaint(const std::string& text) {
    return config_error([&] { make(text); }).what();
  }
  // Whether this machine has ONNX Runtime where a program looks for it.
  static bool has_runtime() {
    try {
      OnnxLibrary::get("test");
      return true;
    } catch (const ConfigError&) {
      return false;
    }
  }
};

std::vector<double> act(Policy& policy, const std::vector<double>& observation) {
  std::vector<double> action(policy.interface().action.size(), 9);
  policy.act(observation, action);
  return action;
}

TEST_F(OnnxPolicies, WithoutTheLibraryAreRefusedWithWhatToInstall) {
  if (has_runtime()) GTEST_SKIP() << "ONNX Runtime is there";
  const std::string message = complaint(description());
  EXPECT_NE(message.find("pip install onnxruntime"), std::string::npos) << message;
  EXPECT_NE(message.find("sum.yaml: line 4, network"), std::string::npos) << message;
}

TEST_F(OnnxPolicies, AreForOneLayoutAndPace) {
  std::string other = description();
  other.replace(other.find("layout_hash: '") + 14, 4, "0000");
  EXPECT_NE(complaint(other).find("layout_hash: expected"), std::string::npos);
  EXPECT_NE(complaint(description("policy_dt: 0.02\n")).find("expected the environment's 0.002 s"),
            std::string::npos);
  EXPECT_NE(complaint(description("memories: {}\n")).find("memories"), std::string::npos);
}

TEST_F(OnnxPolicies, RememberUntilReset) {
  if (!has_runtime()) GTEST_SKIP() << "no ONNX Runtime here";
  const auto policy = make(description()), other = make(description());
  policy->reset(0);
  EXPECT_EQ(act(*policy, {0.25, 0, 0, -0.125}), (std::vector<double>{0.25, 0, 0, -0.125}));
  EXPECT_EQ(act(*policy, {0.25, 0, 0.5, 0}), (std::vector<double>{0.5, 0, 0.5, -0.125}));
  // Instances share a network, not what they remember.
  EXPECT_EQ(act(*other, {0.125, 0, 0, 0}), (std::vector<double>{0.125, 0, 0, 0}));
  // What is not finite leaves the memory alone, and what is beyond the bounds is clipped in the action only.
  EXPECT_EQ(act(*policy, {test::kNaN, 0, 0, 0}), std::vector<double>(4, 0));
  EXPECT_EQ(act(*policy, {2, 0, 0, 0}), (std::vector<double>{1, 0, 0.5, -0.125}));
  EXPECT_EQ(act(*policy, {-2, 0, 0, 0}), (std::vector<double>{0.5, 0, 0.5, -0.125}));
  policy->reset(0);
  EXPECT_EQ(act(*policy, {0, 0, 0, 0}), std::vector<double>(4, 0));
}

TEST_F(OnnxPolicies, SayWhichInputOrOutputDoesNotFit) {
  if (!has_runtime()) GTEST_SKIP() << "no ONNX Runtime here";
  EXPECT_NE(complaint(description("")).find("memory: expected every input that is not the observation"),
            std::string::npos);
  EXPECT_NE(complaint(description("memory: {sum: sum_out}\n")).find("one of obs, sum_in, found 'sum'"),
            std::string::npos);
  write("sum.onnx", summing_network(5));
  EXPECT_NE(complaint(description()).find("obs of the network: expected 4 numbers"), std::string::npos);
  write("sum.onnx", "no network");
  EXPECT_NE(complaint(description()).find("expected an ONNX file that ONNX Runtime computes"),
            std::string::npos);
}

TEST_F(OnnxPolicies, ActOnManyThreadsAtOnce) {
  if (!has_runtime()) GTEST_SKIP() << "no ONNX Runtime here";
  std::vector<std::unique_ptr<Policy>> policies;
  for (int i = 0; i < 4; ++i) policies.push_back(make(description()));
  std::vector<double> sums(policies.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < policies.size(); ++i) {
    threads.emplace_back([&, i] {
      policies[i]->reset(0);
      const double step = std::ldexp(1.0, -10) * static_cast<double>(i + 1);  // sums are exact
      for (int k = 0; k < 200; ++k) sums[i] = act(*policies[i], {step, 0, 0, 0})[0];
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < sums.size(); ++i)
    EXPECT_EQ(sums[i], std::ldexp(200.0 * static_cast<double>(i + 1), -10)) << i;
}

}  // namespace
}  // namespace crossgait
