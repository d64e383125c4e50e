#include "apps/score_server.h"

#include <cerrno>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

#include "apps/interruption.h"
#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/yaml_reader.h"

namespace crossgait::apps {
namespace {

/// Lines of standard input. A signal ends the wait for one.
class InputLines {
 public:
  /// @returns nothing at the end of the input, and for what stands behind its last line
  /// @throws ConfigError for a line that is too long, of which the rest is skipped
  std::optional<std::string> next() {
    constexpr std::size_t kLongest = 65536;
    bool is_too_long = false;
    for (;;) {
      const std::size_t end = kept_.find('\n');
      if (end != std::string::npos) {
        std::string line = kept_.substr(0, end);
        kept_.erase(0, end + 1);
        if (is_too_long || line.size() > kLongest)
          throw ConfigError("standard input", "line", fmt::format("at most {} bytes", kLongest), "more");
        return line;
      }
      if (kept_.size() > kLongest) is_too_long = true, kept_.clear();
      if (!read_more()) return std::nullopt;
    }
  }

 private:
  bool read_more() {
    char buffer[4096];
    for (;;) {
      pollfd input{STDIN_FILENO, POLLIN, 0};
      const int ready = ::poll(&input, 1, -1);
      check_interruption();
      if (ready < 0 && errno == EINTR) continue;
      const ssize_t count = ::read(STDIN_FILENO, buffer, sizeof buffer);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      kept_.append(buffer, static_cast<std::size_t>(count));
      return true;
    }
  }

  std::string kept_;
};

/// The options with what a line says of them. @param policy  gets what it asks for as soon as that is known
ScoredPoliciesOptions asked_for(const std::string& line, ScoredPoliciesOptions options,
                                nlohmann::ordered_json& policy) {
  const YamlValue asked = YamlValue::parse(line, "standard input");
  asked.allow_keys({"policy", "env", "agent", "trained_in"});
  options.policies = {asked.at("policy").text()};
  policy = options.policies.front();
  if (const auto env = asked.find("env")) options.env = env->text();
  if (const auto agent = asked.find("agent")) options.agent = agent->text();
  if (const auto home = asked.find("trained_in")) options.trained_in = {home->text()};
  return options;
}

}  // namespace

void serve_scores(const ScoredPoliciesOptions& options) {
  listen_for_interruption();
  InputLines lines;
  for (;;) {
    nlohmann::ordered_json answered = {{"policy", nullptr}};
    try {
      const std::optional<std::string> line = lines.next();
      if (!line) return;
      const FilesRead apart(FilesRead::Scope::kApart);  // each answer is of the files of its question
      const ScoredPoliciesOptions asked = asked_for(*line, options, answered["policy"]);
      answered["cells"] = to_json(score_them(read_scored(asked), asked.how).cells, asked.how).at("cells");
    } catch (const ConfigError& error) {
      answered["error"] = error.what();
    }
    print_data(answered.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    flush_standard_output();
  }
}

}  // namespace crossgait::apps
