#include "apps/terminal.h"

#include <cctype>
#include <cstdlib>
#include <map>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

namespace crossgait::apps {
namespace {

constexpr std::string_view kRed = "\033[31m", kGreen = "\033[32m", kYellow = "\033[33m", kPlain = "\033[0m";

std::string_view colour_of(std::string_view word) {
  static const std::map<std::string_view, std::string_view> kColours{
      {"agrees", kGreen},      {"differs", kRed}, {"step-dependent", kYellow},
      {"unresolved", kYellow}, {"fell", kRed},    {"collapsed", kRed},
      {"diverged", kRed},      {"slid", kYellow}, {"strayed", kYellow}};
  const auto found = kColours.find(word);
  return found == kColours.end() ? std::string_view() : found->second;
}

bool in_word(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_'; }

}  // namespace

std::optional<std::size_t> terminal_width() {
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return std::nullopt;
  return size.ws_col;
}

bool takes_colours(int stream) {
  const char *const no_colour = std::getenv("NO_COLOR"), *const terminal = std::getenv("TERM");
  return ::isatty(stream) == 1 && (no_colour == nullptr || *no_colour == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

std::string with_colours(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && in_word(text[end])) ++end;
    if (end == i) {
      result += text[i++];
      continue;
    }
    const std::string_view word = std::string_view(text).substr(i, end - i);
    const std::string_view colour = colour_of(word);
    result += colour;
    result += word;
    if (!colour.empty()) result += kPlain;
    i = end;
  }
  return result;
}

std::string message_with_colours(const std::string& message) {
  constexpr std::string_view kError = "crossgait:", kNote = "crossgait: note:";
  const bool note = message.starts_with(kNote);
  if (!note && !message.starts_with(kError)) return message;
  const std::size_t end = (note ? kNote : kError).size();
  return std::string(note ? kYellow : kRed) + message.substr(0, end) + std::string(kPlain) +
         message.substr(end);
}

}  // namespace crossgait::apps
