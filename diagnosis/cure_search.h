// Which changes of an environment are walked, in which order, until one of them cures a policy.
#pragma once

#include <vector>

#include "diagnosis/search.h"

#include "physics/core/progress.h"

namespace crossgait {

/// Tells whether a policy does what it is asked with this candidate, which has been walked whole.
bool cures(const Candidate& candidate, const Search& search);

/// Looks for changes of one field that cure a policy, and of two where none leaves a score that only policies
/// of good habits have.
/// @returns the best of both, walked whole
/// @throws Interrupted from `progress`
std::vector<Candidate> search_cures(Search& search, const Progress& progress);

}  // namespace crossgait
