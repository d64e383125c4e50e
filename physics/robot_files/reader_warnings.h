// What a robot's file holds that is not simulated: one sentence per kind of thing.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "physics/core/error.h"

namespace crossgait {

/// Gathers the numbers and flags (true, false) that an element holds, for people.
class HeldNumbers {
 public:
  /// Adds one if the value is one, or begins with a number. @param name  of the attribute, or of the element
  /// around it
  void add(std::string_view name, std::string_view value);
  /// Says ": soft_lower_limit="-1.5" k_velocity="10"", or nothing of none.
  const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

/// Says what `error` says, and what was left out of a file before, where it found nothing: the cause, as a
/// rule. @param warnings  sentences of a reader
ConfigError with_cause(const ConfigError& error, const std::vector<std::string>& warnings);

/// Counts things by their kind, and remembers where the first of each was.
class ReaderWarnings {
 public:
  /// Counts one more thing of the kind that reads "<before><number><after>", e.g. ("ignored ", " <contact>").
  /// @param where  of this one, e.g. "link 'shin' (line 7)"
  void count(std::string_view before, std::string_view after, std::string_view where);
  /// Counts an attribute that nobody reads, and says what the first one holds, e.g.
  /// ignored 4 attribute(s) 'kp' of \<fixed\>, first in fixed (line 7): kp="40"
  void ignore_attribute(std::string_view name, std::string_view value, std::string_view tag,
                        std::string_view where, std::string_view why = {});
  /// Counts an element that nobody reads, and says which numbers the first one holds.
  /// @param what  "<safety_controller>"
  void ignore_element(std::string_view what, std::string_view where, const HeldNumbers& numbers);
  /// Counts one more thing of the kind that reads "<number> <what>", followed by the names of them all.
  void list(std::string_view what, std::string_view name);
  /// Adds a sentence of its own.
  void add(std::string_view sentence);

  /// Lists warnings in the order of their first things, fit for a terminal; of very many kinds the last
  /// sentence says how many more.
  std::vector<std::string> sentences() const;

 private:
  struct Kind {
    std::string before, after, where;  ///< of the first, or of all
    std::size_t count = 0;
  };
  /// Returns the kind, with one thing more, or null if there are too many.
  Kind* more_of(std::string_view before, std::string_view after);

  std::vector<Kind> kinds_;
  std::map<std::string, std::size_t> index_;  ///< into kinds_, by both parts of the sentence
  std::size_t more_ = 0;                      ///< things of kinds beyond those
};

}  // namespace crossgait
