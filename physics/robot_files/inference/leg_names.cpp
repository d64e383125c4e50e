#include "physics/robot_files/inference/leg_names.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <vector>

namespace crossgait {
namespace {

bool is(int (*kind)(int), char c) { return kind(static_cast<unsigned char>(c)) != 0; }

/// In lower case: "leg_front_l1" and "LegFrontL" are leg, front, l. A capital begins a word after a small
/// letter, or before one: FLHip is fl, hip.
std::vector<std::string> words_in(std::string_view name) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool begins =
        i > 0 && is(std::isupper, c) &&
        (is(std::islower, name[i - 1]) || (i + 1 < name.size() && is(std::islower, name[i + 1])));
    if ((begins || !is(std::isalpha, c)) && !words.back().empty()) words.emplace_back();
    if (is(std::isalpha, c)) words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

std::optional<Leg> leg_at(bool front, bool left) {
  if (front) return left ? Leg::FL : Leg::FR;
  return left ? Leg::RL : Leg::RR;
}

}  // namespace

std::optional<Leg> leg_in_name(std::string_view name) {
  static const std::map<std::string_view, Leg> kShort{
      {"fl", Leg::FL}, {"lf", Leg::FL}, {"fr", Leg::FR}, {"rf", Leg::FR}, {"rl", Leg::RL},
      {"lr", Leg::RL}, {"hl", Leg::RL}, {"lh", Leg::RL}, {"bl", Leg::RL}, {"lb", Leg::RL},
      {"rr", Leg::RR}, {"hr", Leg::RR}, {"rh", Leg::RR}, {"br", Leg::RR}, {"rb", Leg::RR}};
  const std::vector<std::string> words = words_in(name);
  std::string all;
  for (const std::string& word : words) all += word;
  const auto inside = [&](std::string_view part) { return all.find(part) != std::string::npos; };
  const auto among = [&](std::string_view word) { return std::ranges::find(words, word) != words.end(); };
  const bool front = inside("front") || among("fore");
  const bool rear = inside("rear") || inside("hind") || inside("back");
  const bool left = inside("left") || among("l"), right = inside("right") || among("r");
  if (front != rear && left != right) return leg_at(front, left);
  std::optional<Leg> leg;
  for (const std::string& word : words) {
    const auto known = kShort.find(word);
    if (known == kShort.end()) continue;
    if (leg && *leg != known->second) return std::nullopt;
    leg = known->second;
  }
  return leg;
}

}  // namespace crossgait
