#include "physics/robot_files/sdf/sdf_contact.h"

#include <numbers>

#include <fmt/format.h>

#include "physics/robot_files/ode_surface.h"
#include "physics/robot_files/sdf/sdf_values.h"

namespace crossgait {
namespace {

/// Reads a number from 0 on, if it is there.
std::optional<double> size_in(const SdfElement& parent, const char* name) {
  return parent.find(name) == nullptr ? std::nullopt : std::optional(sdf_size(parent, name, 0));
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

}  // namespace

std::optional<ContactNumbers> read_contact(const SdfElement& collision, const std::string& main_file,
                                           ReaderWarnings& warnings) {
  const SdfElement* surface = collision.find("surface");
  if (surface == nullptr) return std::nullopt;
  const std::string place = sdf_place(collision, main_file);
  ContactNumbers numbers;
  OdeSurface of_ode;
  const SdfElement *contact = surface->find("contact"), *friction = surface->find("friction");
  if (const SdfElement* ode = contact == nullptr ? nullptr : contact->find("ode")) {
    of_ode.max_vel = size_in(*ode, "max_vel");
    for (const char* name : {"kp", "kd", "soft_erp", "soft_cfm", "min_depth"})
      if (const auto number = size_in(*ode, name)) of_ode.spring[name] = *number;
  }
  if (contact != nullptr) {
    contact->pass_over("collide_without_contact", {"0", "false"});
    contact->pass_over("collide_without_contact_bitmask", {"1"});
    contact->pass_over("collide_bitmask", {"65535", "0xffff", "0xFFFF"});
    contact->pass_over("category_bitmask", {"65535", "0xffff", "0xFFFF"});
    contact->pass_over("poissons_ratio", {"0.3"});
    contact->pass_over("elastic_modulus", {"-1"});
  }
  if (const SdfElement* ode = friction == nullptr ? nullptr : friction->find("ode")) {
    for (const char* none : {"fdir1", "slip1", "slip2"}) ode->pass_over(none, {"0", "0.0", "0 0 0"});
    of_ode.mu = size_in(*ode, "mu"), of_ode.mu2 = size_in(*ode, "mu2");
  }
  take_ode_surface(of_ode, place, numbers, warnings);
  if (friction != nullptr && friction->find("torsional") != nullptr)
    read_torsional(*friction->find("torsional"), place, numbers, warnings);
  return numbers.is_empty() ? std::nullopt : std::optional(numbers);
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
