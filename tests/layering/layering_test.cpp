#include "crossgait/tests/layering/layering.h"

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
  // The project's own headers alone are more than this: fewer means that the wrong folder was looked at.
  EXPECT_GT(report.files, 20);
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
               {"physics/a.h", "  #  include \"mujoco.h\"", false},
               {"physics/bullet/a.h", "#include <btBulletDynamicsCommon.h>", false},
               {"env/a.cpp", "#include <mjmodel.h>", false},
               {"parity/a.cpp", "#include <bullet/btBulletDynamicsCommon.h>", false},
               {"apps/a.cpp", "#include <LinearMath/btScalar.h>", false},
               {"tests/parity/a_test.cpp", "#include <BulletCollision/x.h>", false}});
}

TEST(Layering, FoldersIncludeOnlyWhatIsBelowThem) {
  expect_rule({{"physics/a.h", "#include \"crossgait/physics/leg.h\"", true},
               {"physics/a.h", "#include \"crossgait/ik/leg_kinematics.h\"", false},
               {"ik/a.h", "#include \"crossgait/physics/leg.h\"", true},
               {"ik/a.h", "#include \"crossgait/gait/trot.h\"", false},
               {"gait/a.h", "#include \"crossgait/ik/leg_kinematics.h\"", false},
               {"gait/a.h", "#include \"crossgait/env/env.h\"", false},
               {"env/a.h", "#include \"crossgait/gait/trot.h\"", true},
               {"env/a.h", "#include \"crossgait/backends/registry.h\"", false},
               {"env/a.h", "#include \"crossgait/parity/report.h\"", false},
               {"parity/a.h", "#include \"crossgait/env/env.h\"", true},
               {"parity/a.h", "#include \"crossgait/backends/registry.h\"", false},
               {"benchmarks/a.cpp", "#include \"crossgait/backends/registry.h\"", true},
               {"benchmarks/a.h", "#include \"crossgait/parity/table.h\"", true},
               {"benchmarks/a.cpp", "#include \"crossgait/backends/bullet/rows.h\"", false},
               {"benchmarks/a.cpp", "#include <mujoco/mujoco.h>", false},
               {"benchmarks/a.cpp", "#include \"crossgait/apps/plotting.h\"", false},
               {"parity/a.cpp", "#include \"crossgait/benchmarks/scenes.h\"", false},
               {"backends/registry.cpp", "#include \"crossgait/backends/mujoco/backend.h\"", false},
               {"backends/plugin_loader.cpp", "#include \"crossgait/physics/engine_plugin.h\"", true},
               {"backends/mujoco/a.cpp", "#include \"crossgait/backends/mujoco/backend.h\"", true},
               {"backends/bullet/a.cpp", "#include \"crossgait/backends/mujoco/backend.h\"", false},
               {"backends/bullet/a.cpp", "#include \"crossgait/backends/contact/cone_solver.h\"", true},
               {"tests/backends/bullet/a.cpp", "#include \"crossgait/backends/contact/cone_solver.h\"", true},
               {"backends/registry.cpp", "#include \"crossgait/backends/contact/cone_solver.h\"", false},
               {"study/a.cpp", "#include \"crossgait/backends/contact/cone_solver.h\"", false},
               {"backends/contact/a.cpp", "#include \"crossgait/backends/bullet/rows.h\"", false},
               {"backends/contact/a.cpp", "#include <LinearMath/btVector3.h>", false},
               {"backends/contact/a.cpp", "#include \"crossgait/gait/trot.h\"", false},
               {"backends/mujoco/a.cpp", "#include \"crossgait/gait/trot.h\"", false},
               {"apps/a.cpp", "#include \"crossgait/backends/mujoco/backend.h\"", false},
               {"tests/backends/a_test.cpp", "#include \"crossgait/backends/bullet/rows.h\"", false},
               {"tests/backends/bullet/a_test.cpp", "#include \"crossgait/backends/bullet/rows.h\"", true},
               {"tests/backends/bullet/a_test.cpp", "#include \"crossgait/backends/mujoco/model.h\"", false},
               {"benchmarks/programs/a.cpp", "#include \"crossgait/backends/bullet/rows.h\"", true},
               {"apps/a.cpp", "#include \"crossgait/backends/registry.h\"", true},
               {"tests/gait/a_test.cpp", "#include \"crossgait/backends/registry.h\"", true},
               {"elsewhere/a.cpp", "", false}});
}

TEST(Layering, WhatIsLinkedToAnEngineOpensNoPlugin) {
  const std::string engine = "#include \"crossgait/backends/mujoco/model.h\"\n";
  for (const std::string opens :
       {"#include \"crossgait/backends/registry.h\"\n", "#include \"crossgait/backends/plugin_loader.h\"\n",
        "#include \"crossgait/tests/support/backend_test.h\"\n"}) {
    expect_rule({{"benchmarks/programs/a.cpp", opens, true},
                 {"benchmarks/programs/a.cpp", engine + opens, false},
                 {"benchmarks/programs/a.cpp", opens + engine, false},
                 {"tests/backends/a_test.cpp", opens, true},
                 {"tests/backends/plugins/a.cpp", opens, true},
                 {"tests/backends/mujoco/a_test.cpp", opens, false}});
  }
}

TEST(Layering, GaitAndIkKnowNoBackend) {
  expect_rule({{"gait/a.h", "#include \"crossgait/physics/physics_backend.h\"", false},
               {"ik/a.h", "void solve(const PhysicsBackend& backend);", false},
               {"gait/a.cpp", "if (engine == \"MuJoCo\") x = 1;", false},
               {"gait/a.cpp", "x = 1;  // as MuJoCo does", true},
               {"env/a.h", "#include \"crossgait/physics/physics_backend.h\"", true}});
}

TEST(Layering, ABadTreeIsReportedByFileAndLine) {
  const fs::path root = fs::temp_directory_path() / ("crossgait_layering_" + std::to_string(getpid()));
  fs::create_directories(root / "gait" / "deep");
  std::ofstream(root / "gait" / "deep" / "bad.h") << "// fine\n#include <mujoco/mujoco.h>\n";
  std::ofstream(root / "gait" / "good.cpp") << "#include \"crossgait/physics/leg.h\"\n";
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
