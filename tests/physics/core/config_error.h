// What a bad input is answered with.
#pragma once

#include <gtest/gtest.h>

#include "physics/core/error.h"

namespace crossgait {

/// Returns the ConfigError that `action` throws; a failure of the test if it throws none.
template <typename Action>
ConfigError config_error(const Action& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error;
  }
  ADD_FAILURE() << "no ConfigError was thrown";
  return {"", "", "", ""};
}

}  // namespace crossgait
