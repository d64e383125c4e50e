#include "ik/ik_status.h"

#include <array>

namespace crossgait {

std::string_view name(IkStatus status) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"ok", "clamped_too_far", "clamped_too_near",
                                                   "clamped_joint_limit", "invalid_target"};
  return kNames[static_cast<std::size_t>(status)];
}

}  // namespace crossgait
