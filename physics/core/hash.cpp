#include "physics/core/hash.h"

#include <fmt/format.h>

namespace crossgait {

std::string Fnv1a::hex() const { return fmt::format("{:016x}", hash_); }

}  // namespace crossgait
