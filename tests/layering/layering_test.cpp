#include "tests/layering/layering.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace crossgait::layering {
namespace {

namespace fs = std::filesystem;

TEST(Layering, TheSourcesKeepTheRules) {
  const TreeReport report = check_tree(CROSSGAIT_SOURCE_DIR);
  for (const Violation& v : report.violations) ADD_FAILURE() << v.file << ":" << v.line << ": " << v.text;
  // 700 and more when this was written: fewer means that folders were not looked at.
  EXPECT_GT(report.files, 700);
}

struct Case {
  std::string file, line;
  bool allowed;
};

void expect_rule(const std::vector<Case>& cases) {
  for (const auto& [file, line, allowed] : cases) {
    EXPECT_EQ(check_file(file, line).empty(), allowed) << file << ": " << line;
  }
}

TEST(Layering, EngineHeadersStayInFoldersNamedForThem) {
  expect_rule({{"backends/mujoco/a.cpp", "#include <mujoco/mujoco.h>", true},
               {"backends/bullet/a.h", "#include <btBulletDynamicsCommon.h>", true},
               {"backends/bullet/a.h", "#include <BulletDynamics/Featherstone/btMultiBody.h>", true},
               {"tests/backends/mujoco/a_test.cpp", "#include <mujoco/mujoco.h>", true},
               {"benchmarks/programs/mujoco/a.cpp", "#include <mujoco/mujoco.h>", true},
               {"backends/bullet/a.cpp", "#include <mujoco/mujoco.h>", false},
               {"backends/mujoco/a.cpp", "#include <LinearMath/btVector3.h>", false},
               {"backends/registry.cpp", "#include <mujoco/mujoco.h>", false},
               {"physics/core/a.h", "  #  include \"mujoco.h\"", false},
               {"physics/core/bullet/a.h", "#include <btBulletDynamicsCommon.h>", false},
               {"env/a.cpp", "#include <mjmodel.h>", false},
               {"parity/a.cpp", "#include <bullet/btBulletDynamicsCommon.h>", false},
               {"apps/a.cpp", "#include <LinearMath/btScalar.h>", false},
               {"tests/parity/a_test.cpp", "#include <BulletCollision/x.h>", false}});
}

TEST(Layering, FoldersIncludeOnlyWhatIsBelowThem) {
  expect_rule({{"physics/engine/a.h", "#include \"physics/robot/leg.h\"", true},
               {"physics/engine/a.h", "#include \"ik/leg_kinematics.h\"", false},
               {"physics/robot/a.h", "#include \"physics/core/error.h\"", true},
               {"physics/robot/a.h", "#include \"physics/engine/world_spec.h\"", false},
               {"physics/core/a.h", "#include \"physics/robot/leg.h\"", false},
               {"physics/robot_files/urdf/a.cpp", "#include \"physics/robot_files/robot_report.h\"", true},
               {"physics/robot_files/urdf/a.cpp", "#include \"physics/terrain/terrain.h\"", false},
               {"physics/a.h", "", false},
               {"motion/a.h", "#include \"ik/leg_kinematics.h\"", true},
               {"motion/a.h", "#include \"policy/policy.h\"", false},
               {"policy/a.h", "#include \"motion/walk.h\"", false},
               {"policy/a.h", "#include \"env/observation.h\"", false},
               {"scenes/a.h", "#include \"benchmarks/speed.h\"", false},
               {"backends/skeleton/a.cpp", "#include \"crossgait/physics/engine/engine.h\"", true},
               {"backends/skeleton/a.cpp", "#include \"crossgait/gait/gait.h\"", false},
               {"ik/a.h", "#include \"physics/robot/leg.h\"", true},
               {"ik/a.h", "#include \"gait/trot.h\"", false},
               {"gait/a.h", "#include \"ik/leg_kinematics.h\"", false},
               {"gait/a.h", "#include \"env/env.h\"", false},
               {"env/a.h", "#include \"gait/trot.h\"", true},
               {"env/a.h", "#include \"backends/registry.h\"", false},
               {"env/a.h", "#include \"parity/report.h\"", false},
               {"parity/a.h", "#include \"env/env.h\"", true},
               {"parity/a.h", "#include \"backends/registry.h\"", false},
               {"benchmarks/a.cpp", "#include \"backends/registry.h\"", true},
               {"benchmarks/a.h", "#include \"physics/core/table.h\"", true},
               {"benchmarks/a.cpp", "#include \"backends/bullet/rows.h\"", false},
               {"benchmarks/a.cpp", "#include <mujoco/mujoco.h>", false},
               {"benchmarks/a.cpp", "#include \"apps/results.h\"", false},
               {"parity/a.cpp", "#include \"scenes/scenes.h\"", false},
               {"backends/registry.cpp", "#include \"backends/mujoco/backend.h\"", false},
               {"backends/plugin_loader.cpp", "#include \"physics/engine/engine_plugin.h\"", true},
               {"backends/mujoco/a.cpp", "#include \"backends/mujoco/backend.h\"", true},
               {"backends/bullet/a.cpp", "#include \"backends/mujoco/backend.h\"", false},
               {"backends/bullet/a.cpp", "#include \"backends/contact/cone_solver.h\"", true},
               {"tests/backends/bullet/a.cpp", "#include \"backends/contact/cone_solver.h\"", true},
               {"backends/registry.cpp", "#include \"backends/contact/cone_solver.h\"", false},
               {"study/a.cpp", "#include \"backends/contact/cone_solver.h\"", false},
               {"backends/contact/a.cpp", "#include \"backends/bullet/rows.h\"", false},
               {"backends/contact/a.cpp", "#include <LinearMath/btVector3.h>", false},
               {"backends/contact/a.cpp", "#include \"gait/trot.h\"", false},
               {"backends/mujoco/a.cpp", "#include \"gait/trot.h\"", false},
               {"apps/a.cpp", "#include \"backends/mujoco/backend.h\"", false},
               {"tests/backends/a_test.cpp", "#include \"backends/bullet/rows.h\"", false},
               {"tests/backends/bullet/a_test.cpp", "#include \"backends/bullet/rows.h\"", true},
               {"tests/backends/bullet/a_test.cpp", "#include \"backends/mujoco/model.h\"", false},
               {"benchmarks/programs/a.cpp", "#include \"backends/bullet/rows.h\"", true},
               {"apps/a.cpp", "#include \"backends/registry.h\"", true},
               {"tests/gait/a_test.cpp", "#include \"backends/registry.h\"", true},
               {"elsewhere/a.cpp", "", false}});
}

TEST(Layering, WhatIsLinkedToAnEngineOpensNoPlugin) {
  const std::string engine = "#include \"backends/mujoco/model.h\"\n";
  for (const std::string opens :
       {"#include \"backends/registry.h\"\n", "#include \"backends/plugin_loader.h\"\n",
        "#include \"tests/support/engine_test.h\"\n"}) {
    expect_rule({{"benchmarks/programs/a.cpp", opens, true},
                 {"benchmarks/programs/a.cpp", engine + opens, false},
                 {"benchmarks/programs/a.cpp", opens + engine, false},
                 {"tests/backends/a_test.cpp", opens, true},
                 {"tests/backends/plugins/a.cpp", opens, true},
                 {"tests/backends/mujoco/a_test.cpp", opens, false}});
  }
}

TEST(Layering, GaitAndIkKnowNoEngine) {
  expect_rule({{"gait/a.h", "#include \"physics/engine/physics_backend.h\"", false},
               {"ik/a.h", "void solve(const PhysicsBackend& world);", false},
               {"gait/a.cpp", "if (engine == \"MuJoCo\") x = 1;", false},
               {"gait/a.cpp", "x = 1;  // as MuJoCo does", true},
               {"env/a.h", "#include \"physics/engine/physics_backend.h\"", true}});
}

TEST(Layering, NothingWaitsByAClockThatIsSet) {
  expect_rule({{"physics/core/a.cpp", "auto end = std::chrono::steady_clock::now() + limit;", true},
               {"physics/core/a.cpp", "auto end = std::chrono::system_clock::now() + limit;", false},
               {"view/a.cpp", "clock_gettime(CLOCK_REALTIME, &now);", false},
               {"apps/a.cpp", "if (fs::last_write_time(path) < limit) {", false},
               {"study/a.cpp", "  // not by system_clock", true},
               {"benchmarks/machine.cpp", "  const std::time_t time = std::time(nullptr);", true},
               {"benchmarks/a.cpp", "  const std::time_t time = std::time(nullptr);", false}});
}

TEST(Layering, AnIncludeIsFoundOnABareCheckout) {
  const fs::path root = CROSSGAIT_SOURCE_DIR;
  const auto lost = [&](std::string_view text) {
    return includes_that_lead_nowhere(root, "ik/a.h", text).size();
  };
  EXPECT_EQ(lost("#include \"physics/robot/leg.h\"\n#include <vector>\n"), 0U);
  EXPECT_EQ(lost("#include \"crossgait/physics/robot/leg.h\"\n"), 0U);
  EXPECT_EQ(lost("#include \"leg.h\"\n#include \"physics/leg.h\"\n"), 2U);
}

TEST(Layering, ABadTreeIsReportedByFileAndLine) {
  const fs::path root = fs::temp_directory_path() / ("crossgait_layering_" + std::to_string(getpid()));
  fs::create_directories(root / "gait" / "deep");
  std::ofstream(root / "gait" / "deep" / "bad.h") << "// fine\n#include <mujoco/mujoco.h>\n";
  std::ofstream(root / "gait" / "good.cpp") << "#include \"gait/deep/bad.h\"\n";
  std::ofstream(root / "gait" / "notes.md") << "#include <mujoco/mujoco.h>\n";
  const TreeReport report = check_tree(root);
  fs::remove_all(root);

  EXPECT_EQ(report.files, 2);
  ASSERT_EQ(report.violations.size(), 2U);  // the engine's header, and the mention of the engine
  for (const Violation& v : report.violations) {
    EXPECT_EQ(v.file, "gait/deep/bad.h");
    EXPECT_EQ(v.line, 2);
  }
}

}  // namespace
}  // namespace crossgait::layering
