// Motions known in closed form, and how far the engines are from them.
#pragma once

#include <string>
#include <vector>

#include "crossgait/benchmarks/robots.h"
#include "crossgait/parity/comparison.h"
#include "crossgait/physics/engine.h"

namespace crossgait::benchmarks {

/// A second of free rotation without gravity: largest drifts.
struct TumblingDrift {
  double momentum = 0;          ///< of the angular momentum, relative
  double energy = 0;            ///< of the energy of rotation at the end, relative, with its sign
  double predicted_energy = 0;  ///< what explicit Euler steps of the gyroscopic torque add
  double velocity = 0;          ///< of the centre of mass, m/s
  double position = 0;          ///< of the centre of mass from its straight line, m
};
/// @throws std::runtime_error (as all below) if the engine diverges
TumblingDrift measure_tumbling(const Engine& engine, double h);

/// Distance from the parabola after a second of free fall, m.
double free_fall_error(const Engine& engine, double h);

/// Mean period over `swings` full swings from rest at `amplitude` (rad), s, timed by zero crossings.
double pendulum_period(const Engine& engine, const scenes::ArmLink& link, double amplitude, double h,
                       int swings);
/// Of the period of a swing of 143 degrees against the elliptic integral, relative.
double pendulum_error(const Engine& engine, double h);

/// Errors of one quantity over the physics step, and how fast they vanish with it.
struct Convergence {
  std::string quantity, unit, backend;
  std::vector<double> step_s, error;
  double order = 0;  ///< p of error = C step^p
};

/// free_fall, pendulum_period, tumbling_momentum and tumbling_energy at steps of 4, 2, 1 and 1/2 ms.
std::vector<Convergence> measure_convergence(const std::vector<std::string>& backends,
                                             const Progress& progress);

}  // namespace crossgait::benchmarks
