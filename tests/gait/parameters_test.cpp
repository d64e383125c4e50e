#include "gait/parameters.h"

#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kNaN;

struct GuideRow {
  const char* name;
  double min, max, default_value, delta_scale;
};

// The ranges and delta scales of the guide, in its order.
constexpr GuideRow kGuideRows[] = {
    {"step_height", 0.03, 0.09, 0.04, 0.005},  {"step_length", 0.03, 0.10, 0.06, 0.005},
    {"cycle_time", 0.8, 1.5, 0.8, 0.05},       {"body_height", 0.04, 0.055, 0.05, 0.003},
    {"stance_width", 0.06, 0.12, 0.08, 0.004}, {"foot_clearance", 0, 0.02, 0.01, 0.002},
};

TEST(ParameterTable, BeginsInTheGuidesOrder) {
  ASSERT_GE(gait_parameters().size(), std::size(kGuideRows));
  for (std::size_t i = 0; i < std::size(kGuideRows); ++i)
    EXPECT_EQ(gait_parameters()[i].name, kGuideRows[i].name);
}

TEST(GuideRanges, AreTheGuides) {
  const AdaptationRanges ranges = guide_ranges();
  EXPECT_NO_THROW(ranges.validate("the guide"));
  for (const GuideRow& guide : kGuideRows) {
    SCOPED_TRACE(guide.name);
    const ParameterRow row = ranges.row(guide.name);
    EXPECT_EQ(row.min, guide.min);
    EXPECT_EQ(row.max, guide.max);
    EXPECT_EQ(guide_adaptive_parameters().*row.member, guide.default_value);
    EXPECT_EQ(row.delta_scale, guide.delta_scale);
  }
}

TEST(ParameterTable, RowsAreSound) {
  std::set<std::string_view> names;
  std::set<double*> members;
  GaitParameters p;
  for (const ParameterRow& row : gait_parameters()) {
    SCOPED_TRACE(row.name);
    EXPECT_TRUE(names.insert(row.name).second);
    EXPECT_TRUE(members.insert(&(p.*row.member)).second);
    EXPECT_FALSE(row.unit.empty() || row.help.empty());
    EXPECT_LT(row.min, row.max);
    EXPECT_GE(row.default_value(), row.min);
    EXPECT_LE(row.default_value(), row.max);
    EXPECT_GT(row.delta_scale, 0);
    EXPECT_LT(row.delta_scale, row.max - row.min);
  }
}

TEST(ParameterTable, NamesEveryNumberOfTheStruct) {
  // All doubles, then the curve in one more word.
  EXPECT_EQ(sizeof(GaitParameters), (gait_parameters().size() + 1) * sizeof(double));
}

TEST(ParameterRow, NormalisesItsRangeToOne) {
  const ParameterRow row = guide_ranges().row("cycle_time");
  EXPECT_EQ(row.normalise(0.8), -1);
  EXPECT_EQ(row.normalise(1.5), 1);
  EXPECT_NEAR(row.normalise(1.15), 0, 1e-15);  // roundings of numbers near one
  EXPECT_EQ(row.clip(2), 1.5);
  EXPECT_EQ(row.clip(0.1), 0.8);
  EXPECT_EQ(row.clip(1.2), 1.2);
}

TEST(SetParameter, SetsByName) {
  GaitParameters p;
  for (const ParameterRow& row : gait_parameters()) {
    set(p, row.name, row.max);
    EXPECT_EQ(p.*row.member, row.max);
    set(p, row.name, row.min);
    EXPECT_EQ(p.*row.member, row.min);
  }
}

TEST(SetParameter, AnUnknownNameIsAnErrorThatListsTheKnown) {
  GaitParameters p;
  try {
    set(p, "step_lenght", 0.05);
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_NE(e.found().find("step_lenght"), std::string::npos);
    EXPECT_NE(e.expected().find("step_length"), std::string::npos);
  }
}

TEST(SetParameter, TakesWhateverIsValidAlsoOutsideTheRange) {
  GaitParameters p;
  set(p, "cycle_time", 1.5);
  set(p, "step_length", 0.125);
  assign(p, "body_height=.08");
  EXPECT_EQ(p.cycle_time, 1.5);
  EXPECT_TRUE(is_valid(p));
  const std::vector<std::string> notes = parameter_notes(p, GaitParameters{});
  ASSERT_EQ(notes.size(), 3U);  // in the order of the table
  EXPECT_EQ(notes[0], "step_length = 0.125 m lies outside the range for adaptation, 0 to 0.12 m");
  EXPECT_EQ(parameter_notes(p, p).size(), 0U) << "as usual";
  AdaptationRanges ranges;
  ranges.ranges["cycle_time"] = {0.8, 1.5};
  EXPECT_EQ(parameter_notes(p, GaitParameters{}, ranges).size(), 2U);
}

TEST(ParameterNotes, SayWhereAFootIsNotLiftedAsAsked) {
  GaitParameters p;
  p.step_height = 0.04;
  p.foot_clearance = 0.02;
  p.body_height = 0.05;
  EXPECT_EQ(parameter_notes(p, p),
            std::vector<std::string>{"step_height and foot_clearance ask for a lift of 0.06 m, to above the "
                                     "shoulders: feet are lifted by 0.0499 m, just below body_height"});
  p.body_height = 0.07;
  EXPECT_EQ(parameter_notes(p, p).size(), 0U);
}

TEST(AdaptationRanges, ReplaceWhatTheyMention) {
  AdaptationRanges ranges;
  ranges.ranges["cycle_time"] = {0.15, 0.8};
  ranges.delta_scales["step_height"] = 0.001;
  EXPECT_NO_THROW(ranges.validate("here"));
  EXPECT_EQ(ranges.row("cycle_time").min, 0.15);
  EXPECT_EQ(ranges.row("cycle_time").delta_scale, find_parameter("cycle_time").delta_scale);
  EXPECT_EQ(ranges.row("step_height").max, find_parameter("step_height").max);
  EXPECT_EQ(ranges.row("step_height").delta_scale, 0.001);
  EXPECT_THROW((void)ranges.row("girth"), ConfigError);
}

TEST(AdaptationRanges, MustBeValidAndWideEnough) {
  const auto element = [](const AdaptationRanges& ranges) {
    try {
      ranges.validate("here");
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.source(), "here");
      return error.element();
    }
    return std::string("none");
  };
  EXPECT_EQ(element({{{"cycle_time", {0.8, 0.15}}}, {}}), "ranges.cycle_time");
  EXPECT_EQ(element({{{"cycle_time", {0.01, 0.8}}}, {}}), "ranges.cycle_time");  // valid from 0.05 s on
  EXPECT_EQ(element({{{"cycle_time", {kNaN, 0.8}}}, {}}), "ranges.cycle_time");
  EXPECT_EQ(element({{}, {{"cycle_time", 0}}}), "delta_scales.cycle_time");
  EXPECT_EQ(element({{{"cycle_time", {0.15, 0.2}}}, {{"cycle_time", 0.06}}}), "delta_scales.cycle_time");
}

TEST(ParameterRow, MovesAValueFromOutsideOnlyNearer) {
  const ParameterRow row = guide_ranges().row("cycle_time");  // 0.8 to 1.5
  EXPECT_EQ(row.moved(1, 0.25), 1.25);
  EXPECT_EQ(row.moved(1, 9), 1.5);
  EXPECT_EQ(row.moved(0.5, 0), 0.5);
  EXPECT_EQ(row.moved(0.5, -0.1), 0.5);
  EXPECT_EQ(row.moved(0.5, 0.125), 0.625);
  EXPECT_EQ(row.moved(2, 1), 2);
  EXPECT_EQ(row.moved(2, -9), 0.8);
}

TEST(SetParameter, AnInvalidValueIsAnErrorWithLimitsAndUnit) {
  for (const double bad : {-1e4, 1e4, kNaN, std::numeric_limits<double>::infinity()}) {
    GaitParameters p;
    try {
      set(p, "step_length", bad);
      FAIL() << "no error";
    } catch (const ConfigError& e) {
      EXPECT_EQ(e.element(), "step_length");
      EXPECT_EQ(e.expected(), "-1000 to 1000 m");
    }
    EXPECT_EQ(p.step_length, GaitParameters{}.step_length);  // untouched
  }
}

TEST(SetParameter, WhatHasNoUnitIsNamedWithoutOne) {
  GaitParameters p;
  try {
    set(p, "duty_factor", 1.2);
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_EQ(e.expected(), "0.05 to 0.95");
  }
  set(p, "duty_factor", 0.4);
  EXPECT_EQ(parameter_notes(p, GaitParameters{}),
            std::vector<std::string>{"duty_factor = 0.4 lies outside the range for adaptation, 0.5 to 0.9"});
}

TEST(AssignParameter, ReadsNumbersAndCurves) {
  GaitParameters p;
  assign(p, "step_length=.08");
  EXPECT_EQ(p.step_length, 0.08);
  assign(p, "cycle_time=1");
  EXPECT_EQ(p.cycle_time, 1);
  assign(p, "swing=matched");
  EXPECT_EQ(p.swing, SwingCurve::kMatched);
  assign(p, "swing=bezier");
  EXPECT_EQ(p.swing, SwingCurve::kBezier);
}

TEST(AssignParameter, NonsenseIsAnError) {
  for (const char* text :
       {"", "step_length", "step_length=", "step_length=6cm", "step_length=nan", "step_length= .08", "=.08",
        "swing=round", "swing=", "no_such=1", "step_length=0.06=0.07"}) {
    GaitParameters p;
    EXPECT_THROW(assign(p, text), ConfigError) << text;
  }
}

TEST(ClipParameters, MovesIntoTheRanges) {
  GaitParameters p;
  p.body_height = 1;
  p.step_height = 0;
  const GaitParameters clipped = clip(p);
  EXPECT_EQ(clipped.body_height, find_parameter("body_height").max);
  EXPECT_EQ(clipped.step_height, find_parameter("step_height").min);
  EXPECT_EQ(clipped.step_length, p.step_length);
}

TEST(GuideParameters, AreTheGuidesDefaults) {
  const GaitParameters p = guide_parameters();
  EXPECT_EQ(p.body_height, 0.07);
  EXPECT_EQ(p.step_length, 0.05);
  EXPECT_EQ(p.step_height, 0.015);
  EXPECT_EQ(p.cycle_time, 0.8);
  EXPECT_EQ(p.swing_shape, 0.35);
  EXPECT_EQ(p.stance_width, 0.08);
  EXPECT_EQ(p.foot_clearance, 0.01);
  EXPECT_TRUE(is_valid(p));
}

TEST(ValidateParameters, AcceptsTheTableAndNamesWhatIsWrong) {
  for (const ParameterRow& row : gait_parameters()) {
    GaitParameters p;
    for (const double good : {row.min, row.max}) {
      p.*row.member = good;
      EXPECT_TRUE(is_valid(p)) << row.name;
    }
    for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -1e9}) {
      p.*row.member = bad;
      EXPECT_FALSE(is_valid(p)) << row.name;
      try {
        validate(p, "here");
        ADD_FAILURE() << row.name;
      } catch (const ConfigError& e) {
        EXPECT_EQ(e.source(), "here");
        EXPECT_EQ(e.element(), row.name);
      }
    }
  }
  for (const auto member : {&GaitParameters::cycle_time, &GaitParameters::body_height}) {
    GaitParameters p;
    p.*member = 0;  // divided by, or nothing to lift from
    EXPECT_FALSE(is_valid(p));
  }
}

}  // namespace
}  // namespace crossgait
