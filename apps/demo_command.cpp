// crossgait demo: one gait on one slope in three engines, and a policy on a steeper one, by commands to
// repeat.
#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"
#include "report/page_template.h"

namespace crossgait::apps {
namespace {

struct DemoCommand {
  std::string page = "crossgait-demo.html";
  bool open = false;
};

// demo.html -> demo-policy.html
std::string policy_page(const std::string& page) {
  const std::filesystem::path p(page);
  return (p.parent_path() / (p.stem().string() + "-policy" + p.extension().string())).string();
}

using Arguments = std::vector<std::string>;

// What every number of the demo depends on is said, also where it is the default.
// @param what  the robot, unless an environment says which that is, what moves it, and the slope
Arguments compare(const Arguments& what, const std::string& impratio) {
  Arguments arguments{"compare"};
  arguments.insert(arguments.end(), what.begin(), what.end());
  arguments.insert(arguments.end(),
                   {"--engines=mujoco,bullet:matched,bullet", "--seed=0", "--seconds=6", "--friction=0.6",
                    "--contact=cone=elliptic,impratio=" + impratio, "--brief"});
  return arguments;
}

std::vector<NextCommand> steps(const DemoCommand& options) {
  const Arguments gait{"--robot=scara_quadruped", "--gait=pace", "--terrain=slope:angle=17"};
  Arguments first = compare(gait, "1");
  Arguments policy = compare({"--policy=scara_adaptive", "--terrain=slope:angle=20"}, "1");
  if (!page_template().empty()) {
    first.push_back("--report=" + options.page);
    if (options.open) first.emplace_back("--open");
    policy.push_back("--report=" + policy_page(options.page));
  }
  return {{"A gait on a slope of 17 degrees: the same robot, gait and seed in three engines.", first},
          {"The same with stiffer friction, which is a setting and not a law: the answer stands.",
           compare(gait, "100")},
          {"On 20 degrees the plain gait, at the speed that the policy below is asked for ...",
           compare({"--policy=zero", "--config=scara_adaptive", "--terrain=slope:angle=20"}, "1")},
          {"... and a learned policy that adapts it.", policy}};
}

}  // namespace

void add_demo_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "demo", "One gait on one slope, which climbs in one engine and slides in another; with a page");
  command->footer(
      "\nRuns commands that it prints, to be repeated and changed. Takes some ten seconds.\n"
      "\nExamples:\n"
      "  crossgait demo --open");
  auto options = std::make_shared<DemoCommand>();
  add_output_option(*command, "--report", options->page,
                    "The page that replays it; that of the policy is beside it, FILE-policy.html")
      ->type_name("FILE.html")
      ->capture_default_str();
  command->add_flag("--open", options->open, "Open the page in the browser")->group(kExecution);
  on_run(*command, [options, &invocation] { invocation.next = steps(*options); });
}

}  // namespace crossgait::apps
