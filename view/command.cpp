#include "view/command.h"

#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kSource = "view command";

[[noreturn]] void refuse(const std::string& element, const std::string& expected, const std::string& found) {
  throw ConfigError(kSource, element, expected, found);
}

/// An object of which every key has to be asked for.
class Keys {
 public:
  explicit Keys(const Json& object) : object_(object) {}

  std::string text(const char* key) { return of(key, &Json::is_string, "a text").get<std::string>(); }
  bool flag(const char* key) { return of(key, &Json::is_boolean, "true or false").get<bool>(); }
  double number(const char* key) { return finite(key, of(key, &Json::is_number, "a number")); }
  std::uint64_t whole(const char* key) {
    return of(key, &Json::is_number_unsigned, "a whole number from 0 to 2^64 - 1").get<std::uint64_t>();
  }
  Vector3 vector(const char* key) {
    const Json& list = of(key, &Json::is_array, "three numbers");
    if (list.size() != 3) refuse(key, "three numbers", fmt::format("{}", list.size()));
    Vector3 v;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!list[i].is_number()) refuse(key, "three numbers", list[i].type_name());
      v[static_cast<Eigen::Index>(i)] = finite(key, list[i]);
    }
    return v;
  }
  std::vector<std::string> texts(const char* key) {
    std::vector<std::string> texts;
    for (const Json& item : of(key, &Json::is_array, "a list of texts")) {
      if (!item.is_string()) refuse(key, "a list of texts", item.type_name());
      texts.push_back(item.get<std::string>());
    }
    return texts;
  }
  void finish() const {
    for (const auto& [key, value] : object_.items()) {
      if (!asked_.contains(key)) refuse(key, "no such key in this command", value.type_name());
    }
  }

 private:
  using Test = bool (Json::*)() const noexcept;
  const Json& of(const char* key, Test is, const char* expected) {
    asked_.insert(key);
    const auto it = object_.find(key);
    if (it == object_.end()) refuse(key, expected, "nothing");
    if (!((*it).*is)()) refuse(key, expected, it->type_name());
    return *it;
  }
  static double finite(const char* key, const Json& value) {
    const double number = value.get<double>();
    if (!std::isfinite(number)) refuse(key, "a finite number", fmt::format("{}", number));
    return number;
  }

  const Json& object_;
  std::set<std::string> asked_;
};

using Reader = ViewCommand (*)(Keys&);

ViewCommand read_drive(Keys& keys) {
  return DriveCommand{{keys.number("vx"), keys.number("vy"), keys.number("yaw_rate")}};
}

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all{
      {"drive", read_drive},
      {"gait", [](Keys& k) -> ViewCommand { return GaitCommand{k.text("gait")}; }},
      {"set",
       [](Keys& k) -> ViewCommand {
         return ParameterCommand{k.text("name"), k.number("value")};
       }},
      {"curve", [](Keys& k) -> ViewCommand { return CurveCommand{k.text("curve")}; }},
      {"push", [](Keys& k) -> ViewCommand { return PushCommand{k.vector("impulse")}; }},
      {"terrain",
       [](Keys& k) -> ViewCommand {
         return TerrainCommand{k.text("terrain"), k.whole("seed")};
       }},
      {"engines", [](Keys& k) -> ViewCommand { return EnginesCommand{k.texts("engines")}; }},
      {"robot", [](Keys& k) -> ViewCommand { return RobotCommand{k.text("robot")}; }},
      {"policy", [](Keys& k) -> ViewCommand { return PolicyCommand{k.text("policy")}; }},
      {"pause", [](Keys& k) -> ViewCommand { return PauseCommand{k.flag("on")}; }},
      {"step", [](Keys& k) -> ViewCommand { return StepCommand{k.whole("steps")}; }},
      {"pace", [](Keys& k) -> ViewCommand { return PaceCommand{k.number("pace")}; }},
      {"back", [](Keys& k) -> ViewCommand { return BackCommand{k.number("seconds")}; }},
      {"change", [](Keys& k) -> ViewCommand { return ChangeCommand{k.texts("changes")}; }},
      {"pull", [](Keys& k) -> ViewCommand { return PullCommand{k.vector("to")}; }},
      {"release", [](Keys&) -> ViewCommand { return ReleaseCommand{}; }},
      {"keep", [](Keys&) -> ViewCommand { return KeepCommand{}; }},
      {"stand", [](Keys&) -> ViewCommand { return StandCommand{}; }},
      {"record", [](Keys& k) -> ViewCommand { return RecordCommand{k.flag("on")}; }},
  };
  return all;
}

// Objects in a list and no deeper: what nests further is no command, and is not read to its end.
Json read_object(std::string_view text) {
  constexpr int kDeepest = 2;
  const auto shallow = [](int depth, Json::parse_event_t, Json&) {
    if (depth > kDeepest) refuse("JSON", "an object that nests no deeper than a list", "one that does");
    return true;
  };
  Json object = Json::parse(text, shallow, false);
  if (!object.is_object())
    refuse("JSON", "an object", object.is_discarded() ? "no JSON" : object.type_name());
  return object;
}

}  // namespace

ViewCommand parse_view_command(std::string_view text) {
  if (text.size() > kMaxCommandBytes) {
    refuse("JSON", fmt::format("at most {} bytes", kMaxCommandBytes), fmt::format("{}", text.size()));
  }
  const Json object = read_object(text);
  Keys keys(object);
  const std::string what = keys.text("do");
  const auto reader = readers().find(what);
  if (reader == readers().end()) {
    std::string known;
    for (const auto& [name, read] : readers()) known += (known.empty() ? "" : ", ") + name;
    refuse("do", known, what);
  }
  ViewCommand command = reader->second(keys);
  keys.finish();
  return command;
}

}  // namespace crossgait
