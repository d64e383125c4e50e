#include "physics/robot_files/ode_surface.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/robot/contact_settings.h"

namespace crossgait {
namespace {

double at_most(double most, double number, std::string_view what, const std::string& place,
               ReaderWarnings& warnings) {
  if (number > most)
    warnings.count(fmt::format("took {:g}, the largest there is, for {} {:g} of ", most, what, number),
                   " surface(s)", place);
  return std::min(number, most);
}

}  // namespace

void take_ode_surface(const OdeSurface& surface, const std::string& place, ContactNumbers& numbers,
                      ReaderWarnings& warnings) {
  // Where one direction alone is said, SDF has 1 in the other.
  if (surface.mu || surface.mu2) {
    const double mu = surface.mu.value_or(1), across = surface.mu2.value_or(mu);
    if (across != mu) {
      warnings.count(fmt::format("took mu {:g} in both directions (mu2 is {:g}) of ", mu, across),
                     " surface(s)", place);
      numbers.not_simulated["mu2"] = {across, "friction is the same in every direction"};
    }
    numbers.friction[0] = at_most(kMostFriction, mu, "mu", place, warnings);
    numbers.stated.insert("friction");
  }
  if (surface.max_vel) {
    numbers.max_depenetration_velocity =
        at_most(kMostDepenetrationVelocity, *surface.max_vel, "max_vel", place, warnings);
    numbers.stated.insert("max_depenetration_velocity");
  }
  for (const auto& [name, value] : surface.spring) {
    // Its erp and cfm are those of kp and kd in steps of Gazebo's, and in none of ours.
    warnings.count("left out ",
                   fmt::format(" <{}> of surfaces: a spring of ODE's (solref, solimp and erp are settings "
                               "of contact here)",
                               name),
                   place);
    numbers.not_simulated[name] = {value, "a spring of ODE's; solref, solimp and erp are settings here"};
  }
}

}  // namespace crossgait
