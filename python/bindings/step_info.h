// What a step tells beside the observation, as Gymnasium's info: of one environment, and of many as arrays.
#pragma once

#include <functional>

#include <nanobind/nanobind.h>

#include "env/quadruped_env.h"

namespace crossgait::python {

/// Returns numbers of the step, its outcome and `reward_terms`: those that have a weight.
nanobind::dict info(const StepInfo& step, const RewardTerms& weights, const nanobind::object& outside);

/// The same of `count` environments as Gymnasium's vector environments have it: an array for every key and a
/// mask of the environments that it is of for its name with an underscore. Zero or None elsewhere.
/// @param step     of environment i, null where there is none
/// @param outside  names of the numbers of its observation that are out of bounds
nanobind::dict infos(std::size_t count, const RewardTerms& weights,
                     const std::function<const StepInfo*(std::size_t i)>& step,
                     const std::function<nanobind::object(std::size_t i)>& outside);

}  // namespace crossgait::python
