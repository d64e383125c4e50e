#include "physics/robot_files/sdf/sdf_contact.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "physics/robot_files/sdf/sdf_values.h"

namespace crossgait {
namespace {

constexpr double kLargestFriction = 10;  // as of ContactSpec

void read_sliding(const SdfElement& ode, const std::string& place, ContactNumbers& numbers,
                  ReaderWarnings& warnings) {
  for (const char* none : {"fdir1", "slip1", "slip2"}) ode.pass_over(none, {"0", "0.0", "0 0 0"});
  if (ode.find("mu") == nullptr) return;
  const double mu = sdf_size(ode, "mu", 1), across = sdf_size(ode, "mu2", mu);
  if (across != mu)
    warnings.count(fmt::format("took mu {:g} in both directions (mu2 is {:g}) of ", mu, across),
                   " collision(s)", place);
  numbers.friction[0] = std::min(mu, kLargestFriction);
  if (mu > kLargestFriction)
    warnings.count(
        fmt::format("took a friction of {:g}, the largest there is, for mu {:g} of ", kLargestFriction, mu),
        " collision(s)", place);
  numbers.stated.insert("friction");
}

void read_torsional(const SdfElement& torsional, const std::string& place, ContactNumbers& numbers,
                    ReaderWarnings& warnings) {
  const double coefficient = sdf_size(torsional, "coefficient", 1);
  const double radius = sdf_size(torsional, "patch_radius", 0);
  if (!sdf_flag(torsional, "use_patch_radius", true)) {
    warnings.count("left out ", " torsional friction of a patch that grows with depth (use_patch_radius)",
                   place);
    torsional.pass_over("surface_radius");
    return;
  }
  torsional.pass_over("surface_radius");  // unused with a patch's
  if (coefficient == 0 || radius == 0) return;
  numbers.friction[1] = 3 * std::numbers::pi / 16 * coefficient * radius;
  numbers.condim = 4;
  numbers.stated.insert({"friction", "condim"});
}

// ODE's spring: its erp and cfm are those of kp and kd in steps of Gazebo's, and in none of ours.
void read_depenetration(const SdfElement& ode, const std::string& place, ContactNumbers& numbers,
                        ReaderWarnings& warnings) {
  constexpr double kFastest = 100;  // m/s, as of ContactSpec
  if (ode.find("max_vel") != nullptr) {
    numbers.max_depenetration_velocity = std::min(sdf_size(ode, "max_vel", 0), kFastest);
    numbers.stated.insert("max_depenetration_velocity");
  }
  for (const char* spring : {"kp", "kd", "soft_erp", "soft_cfm", "min_depth"})
    if (ode.find(spring) != nullptr)
      warnings.count("left out ",
                     fmt::format(" <{}> of surfaces: a spring of ODE's (solref, solimp and erp are settings "
                                 "of contact here)",
                                 spring),
                     place);
}

}  // namespace

std::optional<ContactNumbers> read_contact(const SdfElement& collision, const std::string& main_file,
                                           ReaderWarnings& warnings) {
  const SdfElement* surface = collision.find("surface");
  if (surface == nullptr) return std::nullopt;
  const std::string place = sdf_place(collision, main_file);
  ContactNumbers numbers;
  if (const SdfElement* contact = surface->find("contact")) {
    if (const SdfElement* ode = contact->find("ode")) read_depenetration(*ode, place, numbers, warnings);
    contact->pass_over_all();
  }
  if (const SdfElement* friction = surface->find("friction")) {
    if (const SdfElement* ode = friction->find("ode")) read_sliding(*ode, place, numbers, warnings);
    if (const SdfElement* torsional = friction->find("torsional"))
      read_torsional(*torsional, place, numbers, warnings);
  }
  return numbers.stated.empty() ? std::nullopt : std::optional(numbers);
}

ContactOfFile read_world(const SdfElement& world) {
  ContactOfFile contact;
  const SdfElement* physics = world.find("physics");
  const auto read_gravity = [&contact](const SdfElement& parent) {
    if (parent.find("gravity") == nullptr) return;
    const Vector3 g = sdf_vector(parent, "gravity", Vector3::Zero());
    contact.gravity = {g.x(), g.y(), g.z()};
  };
  if (physics != nullptr) {
    if (physics->find("max_step_size") != nullptr) contact.timestep = sdf_size(*physics, "max_step_size", 0);
    read_gravity(*physics);  // as in 1.4 and 1.5
  }
  read_gravity(world);
  return contact;
}

}  // namespace crossgait
