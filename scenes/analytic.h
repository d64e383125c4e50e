// Motions known in closed form, and how far the engines are from them.
#pragma once

#include "physics/engine/engine.h"
#include "scenes/robots.h"

namespace crossgait::scenes {

/// Holds the largest drifts of a second of free rotation without gravity.
struct TumblingDrift {
  double momentum = 0;          ///< of the angular momentum, relative
  double energy = 0;            ///< of the energy of rotation at the end, relative, with its sign
  double predicted_energy = 0;  ///< what explicit Euler steps of the gyroscopic torque add
  double velocity = 0;          ///< of the centre of mass, m/s
  double position = 0;          ///< of the centre of mass from its straight line, m
};
/// @throws std::runtime_error (as all below) if the engine diverges
TumblingDrift measure_tumbling(const Engine& engine, double h);

/// Returns the distance from the parabola after a second of free fall, m.
double free_fall_error(const Engine& engine, double h);

/// Times the mean period, s, of `swings` full swings from rest at `amplitude` (rad) by zero crossings.
double pendulum_period(const Engine& engine, const ArmLink& link, double amplitude, double h, int swings);
/// Returns the error of the period of a swing of 143 degrees against the elliptic integral, relative.
double pendulum_error(const Engine& engine, double h);

/// Throws a ball at the plane at 1 m/s without gravity, and returns the largest share of its speed with which
/// it leaves, of eight starts an eighth of a step's way apart: 0 where nothing bounces.
double rebound(const Engine& engine, double h);

}  // namespace crossgait::scenes
