// JSON whose objects say each key once: of a key that stands twice, the parser would keep the last and
// readers of other programs the first.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace crossgait {

/// Parses text, of nlohmann's kinds of JSON. Calls `twice(key)`, which throws, for a key that stands twice in
/// an object. @throws Json::parse_error for what is none
template <typename Json, typename Twice>
Json parse_json_once(std::string_view text, const Twice& twice) {
  std::vector<std::set<std::string>> keys;  // of every open object
  return Json::parse(text, [&](int, typename Json::parse_event_t event, Json& parsed) {
    using Event = typename Json::parse_event_t;
    if (event == Event::object_start) {
      keys.emplace_back();
    } else if (event == Event::object_end) {
      keys.pop_back();
    } else if (event == Event::key && !keys.back().insert(parsed.template get<std::string>()).second) {
      twice(parsed.template get<std::string>());
    }
    return true;
  });
}

}  // namespace crossgait
