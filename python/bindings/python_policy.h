// A policy that is a function in Python: what no bundle expresses.
#pragma once

#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <variant>

#include "policy/policy_bundle.h"
#include "python/bindings/behaviour.h"
#include "study/engine_comparison.h"
#include "study/rollout.h"

namespace crossgait::python {

/// Keeps the first exception of functions that are called where nothing may be thrown.
class FirstFailure {
 public:
  void note(const std::exception_ptr& error) noexcept {
    const std::scoped_lock lock(mutex_);
    if (!error_) error_ = error;
  }
  bool noted() const noexcept {
    const std::scoped_lock lock(mutex_);
    return error_ != nullptr;
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  mutable std::mutex mutex_;
  std::exception_ptr error_;
};

/// Holds what makes a controller for every episode.
struct PythonPolicy {
  std::string name;
  SharedObject make;  ///< returns a fresh function of an observation, which returns an action

  /// Returns the policy with what it raises going to `failure`, and its actions zero from then on.
  NamedPolicy named(const std::shared_ptr<FirstFailure>& failure) const;
};

/// Holds a network that is in no file: of a `Policy` in memory.
struct BundlePolicy {
  PolicyBundle bundle;
  std::string name;
};

/// A policy by name or file, one in Python, or one in memory.
using PolicyChoice = std::variant<std::string, PythonPolicy, BundlePolicy>;

/// Returns what tables call a policy.
std::string name_of(const PolicyChoice& choice);

NamedPolicy named(const PolicyChoice& choice, const std::shared_ptr<FirstFailure>& failure);

/// Returns `progress`, which ends the work once a policy has failed.
StageProgress until(const std::shared_ptr<FirstFailure>& failure, const StageProgress& progress);

void bind_python_policy(nb::module_& m);

}  // namespace crossgait::python
