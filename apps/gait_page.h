// A gait as a page.
#pragma once

#include <string>

#include "gait/gait_generator.h"
#include "report/page.h"

namespace crossgait::apps {

/// Shows which feet are meant to stand when, their paths from the side and their targets over time.
/// @param gait  its name  @param generator  at its beginning  @param dt  between samples, s
/// @param samples  after the first
ReportPage gait_page(const std::string& gait, GaitGenerator generator, double dt, int samples);

}  // namespace crossgait::apps
