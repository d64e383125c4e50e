#include "backends/served_engine.h"

#include <algorithm>
#include <map>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "backends/served_memory.h"
#include "physics/core/consent.h"
#include "physics/core/error.h"
#include "physics/core/python_program.h"
#include "physics/core/read_budget.h"
#include "physics/core/sha256.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

// Where the package's own are.
constexpr std::string_view kServedPackage = "crossgait.engines.";
constexpr ReadBudget kProgramBudget{kMebibyte, 1, 1};
// What may be asked of an engine rather than of the description (ServedRequest), and what it may report.
constexpr std::array<std::string_view, 8> kAnswers{"contacts",       "saved",        "mass_matrix",
                                                   "body_pose",      "body_inertia", "terrain_height",
                                                   "joint_friction", "joint_limits"};

/// Reads an engine's description of itself, a member after the other; what is left over is an error.
class InfoReader {
 public:
  InfoReader(std::string source, std::string element, const Json& object)
      : source_(std::move(source)), element_(std::move(element)), object_(object) {
    if (!object.is_object()) fail("", "an object", object.dump());
  }

  template <typename T>
  void read(std::string_view key, const char* expected, T& value) {
    const auto found = object_.find(key);
    if (found == object_.end()) return;
    known_.insert(std::string(key));
    bool fits = false;
    if constexpr (std::same_as<T, bool>) fits = found->is_boolean();
    if constexpr (std::same_as<T, double>) fits = found->is_number();
    if constexpr (std::same_as<T, std::string>) fits = found->is_string();
    if (!fits) fail(key, expected, found->dump());
    value = found->get<T>();
  }
  const Json* part(std::string_view key) {
    const auto found = object_.find(key);
    if (found == object_.end()) return nullptr;
    known_.insert(std::string(key));
    return &*found;
  }
  void finish() const {
    for (const auto& [key, value] : object_.items())
      if (!known_.contains(key))
        fail(key, fmt::format("one of {}", fmt::join(known_, ", ")), "an unknown key");
  }
  [[noreturn]] void fail(std::string_view key, std::string_view expected, std::string_view found) const {
    throw ConfigError(source_, key.empty() ? element_ : fmt::format("{}.{}", element_, key), expected, found);
  }

 private:
  std::string source_, element_;
  const Json& object_;
  std::set<std::string> known_;
};

bool is_of_package(const std::string& program) { return program.starts_with(kServedPackage); }

Laws read_laws(const std::string& file, const Json& object) {
  Laws laws;
  InfoReader reader(file, "laws", object);
  const std::pair<const char*, std::string*> members[] = {{"contact", &laws.contact},
                                                          {"loops", &laws.loops},
                                                          {"joint_friction", &laws.joint_friction},
                                                          {"joint_limits", &laws.joint_limits},
                                                          {"couplings", &laws.couplings},
                                                          {"contact_family", &laws.contact_family}};
  for (const auto& [key, member] : members) reader.read(key, "the name of a law, or an empty text", *member);
  reader.finish();
  if (laws.contact.empty()) reader.fail("contact", "the name of its law of contact", "none");
  return laws;
}

Capabilities read_capabilities(const std::string& file, const Json& object) {
  Capabilities capabilities;
  std::string precision(name_of(capabilities.precision));
  InfoReader reader(file, "capabilities", object);
  const std::pair<const char*, bool*> members[] = {
      {"soft_contact", &capabilities.soft_contact},          {"soft_friction", &capabilities.soft_friction},
      {"turning_friction", &capabilities.turning_friction},  {"pyramidal_cone", &capabilities.pyramidal_cone},
      {"error_reduction", &capabilities.error_reduction},    {"sweeps", &capabilities.sweeps},
      {"exact_field_query", &capabilities.exact_field_query}};
  for (const auto& [key, member] : members) reader.read(key, "true or false", *member);
  reader.read("precision", "'float64' or 'float32'", precision);
  reader.finish();
  if (precision == name_of(Precision::kFloat32)) {
    capabilities.precision = Precision::kFloat32;
  } else if (precision != name_of(Precision::kFloat64)) {
    reader.fail("precision", "'float64' or 'float32'", fmt::format("'{}'", precision));
  }
  return capabilities;
}

}  // namespace

ServedEngine::ServedEngine(std::string name, std::string file, std::string_view text)
    : file_(std::move(file)) {
  info_.name = std::move(name);
  std::unique_ptr<ServedProcess> process = start();
  constexpr std::size_t kStampDigits = 12;
  read_info(process->text(), is_of_package(file_) ? "" : sha256_hex(text).substr(0, kStampDigits));
  give_back(std::move(process));
}

std::unique_ptr<ServedProcess> ServedEngine::start() const {
  const std::vector<std::string> command =
      is_of_package(file_) ? python_module_command(file_) : python_file_command(file_);
  auto process = std::make_unique<ServedProcess>(file_, command, kServedBytes, served_limit());
  Json blocks = Json::object();
  std::size_t place = 0;
  for (const ServedBlock& block : kServedBlocks) {
    blocks[std::string(block.name)] = {place, block.count};
    place += block.count;
  }
  process->set_text(
      Json{{"protocol", kServedVersion}, {"numbers_at", kServedNumbersAt}, {"blocks", blocks}}.dump());
  process->request(static_cast<unsigned>(ServedRequest::kHello), "the beginning");
  process->throw_if_lost();
  return process;
}

void ServedEngine::read_info(std::string_view text, std::string_view stamp) {
  check_json_budget(text, kJsonBudget, file_);
  const Json said = Json::parse(text, nullptr, false);
  if (said.is_discarded()) throw ConfigError(file_, "the engine", "a description in JSON", "another text");
  InfoReader reader(file_, "the engine", said);
  double protocol = 0;
  reader.read("protocol", "a number", protocol);
  if (protocol != static_cast<double>(kServedVersion))
    reader.fail("protocol", fmt::format("version {}, of this Crossgait", kServedVersion),
                fmt::format("{:g}", protocol));
  reader.read("library", "the name of its library", info_.library);
  reader.read("version", "the version of its library", info_.version);
  reader.read("mode", "its contact mode in words", info_.mode);
  bool own_dynamics = false;
  reader.read("equations", "true or false", equations_);
  reader.read("own_dynamics", "true or false", own_dynamics);
  reader.read("contact_margin", "a length, m", margin_);
  if (info_.library.empty()) reader.fail("library", "the name of its library", "none");
  if (!(margin_ >= 0)) reader.fail("contact_margin", "a length, m", fmt::format("{}", margin_));
  if (const Json* laws = reader.part("laws")) info_.laws = read_laws(file_, *laws);
  if (info_.laws.contact.empty()) reader.fail("laws", "laws with the name of that of contact", "none");
  if (const Json* can = reader.part("capabilities")) info_.capabilities = read_capabilities(file_, *can);
  if (const Json* list = reader.part("answers")) {
    for (const Json& what : *list) {
      const std::string name = what.is_string() ? what.get<std::string>() : what.dump();
      if (std::ranges::find(kAnswers, name) == kAnswers.end())
        reader.fail("answers", fmt::format("some of {}", fmt::join(kAnswers, ", ")), name);
      answers_.push_back(name);
    }
  }
  reader.finish();
  if (!stamp.empty()) info_.version += fmt::format("{}{}", info_.version.empty() ? "" : "+", stamp);
  info_.capabilities.allocates = true;  // of its memory nobody knows here
  if (equations_ && !own_dynamics) info_.own_parts = {"equations of motion", "soft loops"};
}

bool ServedEngine::answers(std::string_view what) const {
  return std::ranges::find(answers_, what) != answers_.end();
}

std::unique_ptr<ServedProcess> ServedEngine::take() {
  {
    const std::lock_guard lock(mutex_);
    // Of a fork's copies nothing can be asked; they stay with the process that has them.
    std::erase_if(idle_, [](const auto& process) { return process->is_of_another_process(); });
    if (!idle_.empty()) {
      std::unique_ptr<ServedProcess> process = std::move(idle_.back());
      idle_.pop_back();
      return process;
    }
  }
  return start();
}

void ServedEngine::give_back(std::unique_ptr<ServedProcess> process) {
  if (process == nullptr || process->is_lost() || process->is_of_another_process()) return;
  const std::lock_guard lock(mutex_);
  if (idle_.size() < std::max(1U, std::thread::hardware_concurrency())) idle_.push_back(std::move(process));
}

std::optional<Engine> find_served_engine(std::string_view name) {
  if (!name.starts_with(kServedPrefix)) return std::nullopt;
  std::string program(name.substr(kServedPrefix.size())), text;
  const bool is_file = program.ends_with(".py");
  const auto is_of_name = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (!is_file && (program.empty() || !std::ranges::all_of(program, is_of_name)))
    throw ConfigError(
        "engine", name,
        fmt::format("'{}FILE.py', a file that serves one, or '{}NAME', one that Crossgait's package "
                    "brings",
                    kServedPrefix, kServedPrefix),
        fmt::format("'{}'", program));
  // Never given back: worlds of other threads may outlast whatever runs at the end of the process, and with
  // it the programs end by themselves.
  static auto* mutex = new std::mutex;
  static auto* known = new std::map<std::pair<std::string, std::string>, std::shared_ptr<ServedEngine>>;
  if (is_file) {
    text = read_text_file(program, kProgramBudget);
    require_consent(program, "Python serves it as an engine");
  } else {
    program.insert(0, kServedPackage);
  }
  const std::lock_guard lock(*mutex);
  std::shared_ptr<ServedEngine>& engine = (*known)[{program, text}];
  if (engine == nullptr) engine = std::make_shared<ServedEngine>(std::string(name), program, text);
  return Engine{engine->info(), [engine](const WorldSpec& spec) { return engine->make_world(spec); }};
}

}  // namespace crossgait
