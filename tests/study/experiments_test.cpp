// What experiments left: policies that still run in the environment beside them.
#include <filesystem>

#include <gtest/gtest.h>

#include "env/env_model.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

TEST(Experiments, PoliciesThatWereKeptFitTheirEnvironments) {
  std::size_t found = 0;
  for (const auto& file : fs::recursive_directory_iterator(CROSSGAIT_SOURCE_DIR "/experiments/results")) {
    const fs::path folder = file.path().parent_path();
    if (file.path().filename() != "environment.yaml") continue;
    SCOPED_TRACE(folder.string());
    const PolicyInterface interface = EnvModel::make(load_env_config(file.path()))->interface;
    const fs::path bundle = folder / "best.safetensors";
    EXPECT_NE(make_policy(fs::exists(bundle) ? bundle : folder / "best.yaml", interface), nullptr);
    ++found;
  }
  EXPECT_GE(found, 12U);  // nine of the training study, three of the hierarchy's
}

}  // namespace
}  // namespace crossgait
