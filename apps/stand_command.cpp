// crossgait stand: where a robot's joints end up when it stands, and what that takes of its servos.
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/contact_option.h"
#include "physics/core/schema.h"
#include "study/robot_quantities.h"
#include "study/stand.h"

namespace crossgait::apps {
namespace {

struct StandCommand {
  std::string robot = "scara_quadruped";
  std::vector<std::string> engines;
  double seconds = 3, physics_dt = 1e-3;
  ContactOptions contact;
  JsonOption json;
};

void run(const StandCommand& options) {
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(load_robot_with_warnings(options.robot));
  world.physics_dt = options.physics_dt;
  world.contact = resolve_contact(world.robot->contact, options.contact.make(), "stand");
  world.validate();
  print_notes(step_warnings(*world.robot, world.contact, options.physics_dt));
  const std::vector<std::string> engines = engines_or_all(options.engines);
  ResultInputs inputs = of_robot(*world.robot);
  inputs.engines = engines;
  inputs.chosen = {{"--engines", engines}};
  const Provenance provenance = options.json.provenance(inputs);
  const std::vector<Standing> standings = stand(world, engines, options.seconds);
  options.json.emit(describe(standings),
                    with_schema("stand", {{"robot", world.robot->name},
                                          {"seconds", options.seconds},
                                          {"engines", to_json(standings)}}),
                    provenance);
}

}  // namespace

void add_stand_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "stand", "Stand at the home pose: angles, torques and sag of every servo, in every engine");
  command->footer(
      "\nExamples:\n  crossgait stand --robot my.urdf\n"
      "  crossgait stand --robot my.xml --engines mujoco,bullet --json -");
  auto options = std::make_shared<StandCommand>();
  add_robot_option(*command, options->robot);
  command
      ->add_option(
          "--engines,--engine", options->engines,
          "Engines and modes, comma-separated (see `crossgait engines`); unless given, all that are there")
      ->delimiter(',');
  command->add_option("--seconds", options->seconds, "Simulated time to stand, s, 0.5 to 1000")
      ->capture_default_str();
  command->add_option("--physics-dt", options->physics_dt, "Physics time step, s")->capture_default_str();
  options->contact.add_to(*command);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
