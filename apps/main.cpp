// crossgait: one quadruped gait stack over several physics engines, on the command line.
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "crossgait/apps/command.h"
#include "crossgait/physics/error.h"

namespace {

constexpr int kFailure = 1;
constexpr int kBadInput = 2;

constexpr const char* kDescription =
    "Runs the same quadruped gait in several physics engines and says how far they agree.\n"
    "Start with:  crossgait compare --terrain rough\n";
constexpr const char* kFooter =
    "\nUnits are SI, angles radians unless a name says otherwise. Exit codes: 0 done, 1 failed, 2 bad "
    "input.\n"
    "`crossgait COMMAND --help` explains each command.";

}  // namespace

int main(int argc, char** argv) {
  CLI::App program(kDescription, "crossgait");
  program.footer(kFooter);
  program.set_version_flag("--version", CROSSGAIT_VERSION);
  program.require_subcommand(1);
  try {
    using namespace crossgait::apps;
    add_walk_command(program);
    add_compare_command(program);
    add_bench_command(program);
    add_verdict_command(program);
    add_backends_command(program);
    add_robots_command(program);
    add_terrain_command(program);
    add_ik_command(program);
    add_gait_command(program);
    add_workspace_command(program);
    add_plot_command(program);
    add_env_command(program);
    add_rollout_command(program);
    add_transfer_command(program);
    add_tune_command(program);
    program.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return program.exit(help);
  } catch (const CLI::ParseError& error) {
    program.exit(error);
    return kBadInput;
  } catch (const crossgait::ConfigError& error) {
    fmt::print(stderr, "crossgait: {}\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "crossgait: {}\n", error.what());
    return kFailure;
  }
  return 0;
}
