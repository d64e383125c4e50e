// The page of `crossgait diagnose`.
#pragma once

#include <string>

#include "diagnosis/diagnosis.h"

#include "report/page.h"

namespace crossgait::apps {

/// Shows the sentence, the changes by their effect, what was asked and what came of it, the tests without
/// walking, and every command replayed, as given beside the first of the ranking: of the start that it did
/// worst.
/// @param policy  as `diagnose` took it  @param seed  of the starts
/// @throws ConfigError as `diagnose`
ReportPage diagnose_page(const Diagnosis& found, const LoadedEnv& environment, const std::string& policy,
                         std::uint64_t seed);

}  // namespace crossgait::apps
