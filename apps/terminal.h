// What the terminal is that people read, and text as it takes it.
#pragma once

#include <optional>
#include <string>

namespace crossgait::apps {

/// Returns the width of the terminal that standard output is, in characters; empty if it is none, or unknown.
std::optional<std::size_t> terminal_width();

/// Tells if a stream is a terminal that takes colours: not with NO_COLOR (no-color.org), nor if TERM is dumb.
/// @param stream  its file descriptor
bool takes_colours(int stream);

/// Makes words of results stand out: those of verdicts, and outcomes that are none to wish for.
std::string with_colours(const std::string& text);

/// Makes a message's beginning stand out: "crossgait:" of an error, "crossgait: note:" of a note.
std::string message_with_colours(const std::string& message);

}  // namespace crossgait::apps
