// A live session that goes on for ever takes no more memory: its steps allocate nothing.
#include <gtest/gtest.h>

#include "physics/robot_files/data_path.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/engine_test.h"
#include "view/session.h"

namespace crossgait {
namespace {

class ViewAllocation : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(ViewAllocation);

TEST_P(ViewAllocation, NoneWhileItIsDriven) {
  if (capabilities().allocates) GTEST_SKIP() << "the engine's own library allocates";
  ViewSetup setup;
  setup.world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped")));
  setup.engines = {GetParam()};
  ViewSession session(setup, {{GetParam()}, [](const std::string& name) { return find_engine(name); }});
  session.apply(DriveCommand{{0.2, 0, 0.1}});
  session.advance(501);  // what is made once is made, and so is a moment to go back to
  for (int moment = 0; moment < 20; ++moment) {
    {
      const AllocationScope scope;
      session.advance(49);
      EXPECT_EQ(scope.count(), 0U);
    }
    session.advance(1);  // the next moment: ten a second
  }
}

}  // namespace
}  // namespace crossgait
