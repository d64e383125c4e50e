// A result of the benchmark as a page.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "report/page.h"

namespace crossgait::apps {

/// Shows what `crossgait bench` prints, with charts by section. @param result  as `read_bench` takes it
ReportPage bench_page(const nlohmann::ordered_json& result);

}  // namespace crossgait::apps
