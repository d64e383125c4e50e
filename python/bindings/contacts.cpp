// What a world is read of: its contacts, and a saved instant; all of them can be pickled.
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "physics/core/error.h"
#include "physics/engine/physics_backend.h"
#include "python/bindings/bindings.h"
#include "python/bindings/not_made.h"
#include "python/bindings/world_snapshot.h"

namespace crossgait::python {
namespace {

// body, leg, p_WP, normal, distance, force, slip_speed
using SavedContact = std::tuple<int, int, Vector3, Vector3, double, Vector3, double>;

SavedContact saved_contact(const Contact& c) {
  return {c.body, c.leg, c.p_WP, c.normal, c.distance, c.force, c.slip_speed};
}

Contact contact_of(const SavedContact& saved) {
  Contact c;
  std::tie(c.body, c.leg, c.p_WP, c.normal, c.distance, c.force, c.slip_speed) = saved;
  if (c.leg < -1 || c.leg >= kLegCount || c.body < 0)
    throw ConfigError("contact", "leg and body", fmt::format("-1 to {} and at least 0", kLegCount - 1),
                      fmt::format("{} and {}", c.leg, c.body));
  return c;
}

// body, force, torque, point in the body's frame
using SavedWrench = std::tuple<int, Vector3, Vector3, Vector3>;

// world, engine name, state, contacts and how many were dropped, torques, torques of servos, push, diverged,
// drives, the engine's own, wrenches
using SavedSnapshot = std::tuple<std::string, std::string, RobotState, std::vector<SavedContact>, int,
                                 Eigen::VectorXd, Eigen::VectorXd, Vector3, bool, std::vector<double>,
                                 std::vector<double>, std::vector<SavedWrench>>;

SavedSnapshot saved_snapshot(const WorldSnapshot& s) {
  std::vector<SavedContact> contacts;
  for (const Contact& contact : s.contacts) contacts.push_back(saved_contact(contact));
  std::vector<SavedWrench> wrenches;
  for (const BodyWrench& w : s.wrenches)
    wrenches.emplace_back(w.body, w.wrench.force, w.wrench.torque, w.p_BP);
  return {s.world,         s.engine_name, s.state,    contacts, s.contacts.dropped, s.torques,
          s.servo_torques, s.push,        s.diverged, s.drives, s.engine,           wrenches};
}

WorldSnapshot snapshot_of(const SavedSnapshot& saved) {
  const auto& [world, engine_name, state, contacts, dropped, torques, servo_torques, push, diverged, drives,
               engine, wrenches] = saved;
  WorldSnapshot s{{engine_name, state, {}, torques, servo_torques, push, diverged, drives, engine}, world};
  for (const SavedContact& contact : contacts) s.contacts.add(contact_of(contact));
  s.contacts.dropped = dropped;
  for (const auto& [body, force, torque, point] : wrenches)
    s.wrenches.push_back({body, {force, torque}, point});
  return s;
}

}  // namespace

void bind_contacts(nb::module_& m) {
  nb::class_<Contact>(m, "Contact",
                      "A contact point between the robot and the ground in the last physics step.")
      .def("__init__", not_made<Contact>("contacts are those of World.contacts"), nb::sig(kNotMade))
      .def_ro("body", &Contact::body, "Index into `Robot.bodies`.")
      .def_ro("leg", &Contact::leg, "0 to 3 for the foot of FL, FR, RL, RR; -1 for anything else.")
      .def_ro("p_WP", &Contact::p_WP, "m.")
      .def_ro("normal", &Contact::normal, "Unit vector from the ground to the robot.")
      .def_ro("distance", &Contact::distance, "m, negative where they overlap.")
      .def_ro("force", &Contact::force, "On the robot, in W, N.")
      .def_ro("slip_speed", &Contact::slip_speed, "m/s.")
      .def("__repr__",
           [](const Contact& c) {
             const std::string of =
                 c.leg < 0 ? fmt::format("body {}", c.body) : std::string(name(static_cast<Leg>(c.leg)));
             return fmt::format(
                 "<crossgait.Contact of {} at ({:.4f}, {:.4f}, {:.4f}) m, {:.4g} N, {:.3g} m deep>", of,
                 c.p_WP.x(), c.p_WP.y(), c.p_WP.z(), c.force.norm(), -c.distance);
           })
      .def("__getstate__", &saved_contact)
      .def("__setstate__",
           [](Contact& c, const SavedContact& saved) { new (&c) Contact(contact_of(saved)); });
  nb::class_<FootContact>(m, "FootContact", "All contact points of one foot together.")
      .def("__init__", not_made<FootContact>("contacts of feet are those of World.foot_contacts"),
           nb::sig(kNotMade))
      .def_ro("touching", &FootContact::touching)
      .def_ro("force", &FootContact::force, "Sum, in W, N.")
      .def_ro("p_WP", &FootContact::p_WP, "Position of the deepest point, m.")
      .def_ro("slip_speed", &FootContact::slip_speed, "At the deepest point, m/s.")
      .def_ro("penetration", &FootContact::penetration, "Penetration of the deepest point, m.")
      .def("__repr__",
           [](const FootContact& f) {
             return f.touching ? fmt::format("<crossgait.FootContact of {:.4g} N, {:.3g} m deep>",
                                             f.force.norm(), f.penetration)
                               : std::string("<crossgait.FootContact: none>");
           })
      .def("__getstate__",
           [](const FootContact& f) {
             return std::tuple(f.touching, f.force, f.p_WP, f.slip_speed, f.penetration);
           })
      .def("__setstate__",
           [](FootContact& f, const std::tuple<bool, Vector3, Vector3, double, double>& saved) {
             const auto& [touching, force, p_WP, slip_speed, penetration] = saved;
             new (&f) FootContact{touching, force, p_WP, slip_speed, penetration};
           });
  nb::class_<WorldSnapshot>(m, "Snapshot", "A saved instant of a world: restoring it continues bit for bit.")
      .def("__init__", not_made<WorldSnapshot>("a Snapshot is what World.save makes"), nb::sig(kNotMade))
      .def_ro("engine_name", &WorldSnapshot::engine_name)
      .def_ro("state", &WorldSnapshot::state)
      .def("__repr__",
           [](const WorldSnapshot& s) {
             return fmt::format("<crossgait.Snapshot of a world in {} at {:g} s>", s.engine_name,
                                s.state.time);
           })
      .def("__getstate__", &saved_snapshot)
      .def("__setstate__",
           [](WorldSnapshot& s, const SavedSnapshot& saved) { new (&s) WorldSnapshot(snapshot_of(saved)); });
}

}  // namespace crossgait::python
