// The page that reports fill in, built from web/ when Node.js is there.
#pragma once

#include <string_view>

namespace crossgait {

/// Returns the template; empty where Crossgait was built without the page (CROSSGAIT_WITH_PAGE).
std::string_view page_template();

}  // namespace crossgait
