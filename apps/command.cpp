#include "apps/command.h"

#include <atomic>
#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/interruption.h"
#include "backends/registry.h"
#include "physics/core/consent.h"
#include "physics/core/error.h"
#include "physics/core/table.h"
#include "physics/core/text.h"
#include "physics/robot_files/data_path.h"
#include "physics/robot_files/file_arguments.h"
#include "physics/robot_files/robot_report.h"
#include "study/robot_findings.h"
#include "study/robot_quantities.h"

namespace crossgait::apps {

CLI::Validator above_zero() {
  const auto check = [](const std::string& text) {
    const std::optional<double> number = parse_number(text);
    return number && *number > 0 ? std::string() : fmt::format("expected a number above 0, found {}", text);
  };
  return {check, "POSITIVE"};
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) print_error(fmt::format("crossgait: note: {}\n", note));
}

std::vector<std::string> engines_or_all(const std::vector<std::string>& named) {
  return named.empty() ? available_engines() : named;
}

RobotDescription load_robot_with_warnings(const std::string& robot) {
  const std::string file = find_robot(robot);
  if (!is_robot_file(robot) && !file.starts_with(models_dir()))
    print_notes({fmt::format("{}: {}", robot, file)});
  LoadedRobot loaded = load_robot_with_report(file, servo_source());
  const std::vector<RobotFinding> findings = robot_findings(loaded);
  if (!findings.empty() && findings.front().severity == Severity::kError)
    print_notes({fmt::format("{}: {}", loaded.robot.source, describe(findings.front()))});
  if (const std::size_t count = robot_warnings(loaded, world_of(loaded)).size(); count > 0) {
    print_notes({fmt::format("{}: {} on what its file holds: crossgait robots {}", loaded.robot.source,
                             counted(count, "warning"), robot)});
  }
  return std::move(loaded.robot);
}

namespace {

void set_xacro_arguments(const std::vector<std::string>& texts) {
  FileArguments arguments;
  for (const std::string& text : texts) {
    const std::size_t at = text.find(":=");
    if (at == 0 || at == std::string::npos)
      throw ConfigError("command line", "--xacro-arg", "NAME:=VALUE", fmt::format("'{}'", text));
    arguments[text.substr(0, at)] = text.substr(at + 2);
  }
  set_given_file_arguments(std::move(arguments));
}

}  // namespace

void add_robot_option(CLI::App& command, std::string& robot) {
  command.add_option("--robot", robot, "A bundled robot's name (see `crossgait robots`) or a file")
      ->type_name("NAME|FILE.yaml|FILE.urdf|FILE.xml|FILE.sdf|FILE.xacro")
      ->capture_default_str();
  add_robot_file_options(command);
}

void add_robot_file_options(CLI::App& command) {
  command
      .add_option_function<std::string>(
          "--servos",
          [](const std::string& servos) {
            set_servo_source(servos == "rule" ? ServoSource::kRule : ServoSource::kFile);
          },
          "Gains: those of the robot's files, or those of the rule for robots of its mass and height "
          "(docs/robots.md)")
      ->check(CLI::IsMember({"file", "rule"}))
      ->type_name("file|rule");
  command
      .add_option_function<std::vector<std::string>>(
          "--xacro-arg", set_xacro_arguments,
          "An argument of a robot's .xacro file, over its robot.yaml's; may be repeated")
      ->type_name("NAME:=VALUE");
  add_trust_option(command);
}

void add_trust_option(CLI::App& command) {
  command
      .add_option_function<std::vector<std::string>>(
          "--trust",
          [](const std::vector<std::string>& folders) {
            for (const std::string& folder : folders) trust_folder(folder, "command line");
          },
          "Files in this folder may run code: xacro, TorchScript, pickles (SECURITY.md); may be repeated")
      ->type_name("FOLDER")
      ->group(kExecution);  // whoever runs a command trusts, not the file that it is recorded in
}

std::string problem_with_seed(const std::string& text) {
  return parse_seed(text) ? std::string() : fmt::format("expected {}, found {}", kSeedInWords, text);
}

std::vector<double> parse_numbers(const std::string& text, std::size_t count, const std::string& option,
                                  const std::string& expected) {
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(text, ",")) {
    const auto number = parse_number(part);
    if (!number) throw ConfigError("command line", option, expected, fmt::format("\"{}\"", text));
    numbers.push_back(*number);
  }
  if (numbers.size() != count)
    throw ConfigError("command line", option, expected, fmt::format("\"{}\"", text));
  return numbers;
}

namespace {
std::atomic<bool> progress_is_shown = false;
}  // namespace

void clear_progress() noexcept {
  if (!progress_is_shown.exchange(false)) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

ProgressLine::ProgressLine(std::string label)
    : label_(std::move(label)),
      terminal_(isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()) {
  listen_for_interruption();
}

ProgressLine::~ProgressLine() { clear_progress(); }

void ProgressLine::update(double share) {
  check_interruption();
  using std::chrono::steady_clock;
  if (!terminal_ || steady_clock::now() - begin_ < std::chrono::seconds(2)) return;
  const double elapsed = std::chrono::duration<double>(steady_clock::now() - begin_).count();
  const double left = share > 0 ? elapsed * (1 - share) / share : 0;
  fmt::print(stderr, "\r\033[K{}: {:3.0f} %, {:.0f} s left", printable_text(label_, std::string::npos),
             100 * share, left);
  std::fflush(stderr);
  progress_is_shown = true;
}

std::function<void(const std::string&, double)> Stages::progress() {
  return [this](const std::string& stage, double share) {
    if (stage != stage_ || line_ == nullptr) {
      line_.reset();  // clears its line before the next begins
      line_ = std::make_unique<ProgressLine>(stage);
      stage_ = stage;
    }
    line_->update(share);
  };
}

}  // namespace crossgait::apps
