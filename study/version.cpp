#include "study/version.h"

namespace crossgait {

std::string_view crossgait_version() noexcept { return CROSSGAIT_VERSION; }

}  // namespace crossgait
