// What the import of a policy says of its environment.
#pragma once

#include <string>
#include <vector>

namespace crossgait {

/// Lists the names of fields that nobody said, as import.json in the policy's folder has them; nothing for a
/// policy without one.
/// @param policy  as `load_policy` takes it  @throws ConfigError for a table that cannot be read
std::vector<std::string> unstated_fields(const std::string& policy);

/// Tells whether `crossgait import` made the policy's folder. @throws ConfigError as `unstated_fields`
bool is_imported(const std::string& policy);

}  // namespace crossgait
