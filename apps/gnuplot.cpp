#include "apps/gnuplot.h"

#include <stdexcept>

#include <fmt/format.h>

#include "apps/child_process.h"
#include "physics/core/error.h"

namespace crossgait::apps {

std::string gnuplot_quoted(std::string_view text) {
  // Between single quotes only the single quote itself is special (between double quotes, gnuplot would run
  // what stands in backquotes).
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return quoted + "'";
}

std::string run_gnuplot(const std::string& script) {
  const std::optional<ChildResult> drawn = run_child({"gnuplot", "--default-settings"}, script);
  if (!drawn) {
    throw ConfigError("picture", "gnuplot", "the program that draws it (Debian package gnuplot-nox)",
                      "none installed");
  }
  if (drawn->exit_code != 0 || drawn->out.empty())
    throw std::runtime_error(fmt::format("gnuplot could not draw: {}", drawn->errors));
  return drawn->out;
}

}  // namespace crossgait::apps
