// What is fed with bytes that no one has written on purpose, by name.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace crossgait::fuzz {

/// Reads `bytes` in one of the ways in which Crossgait reads what others wrote. Bad input ends in a
/// ConfigError and in nothing else: any other exception, signal or sanitizer's complaint is a finding.
struct Target {
  std::string_view name;
  std::string_view suffix;  ///< of the file that is read; empty: it is read from memory
  void (*read)(const std::string& file, std::string_view bytes);
};

std::span<const Target> targets();

}  // namespace crossgait::fuzz
