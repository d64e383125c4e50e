// Text that people read, made to fit the width of their terminal.
#pragma once

#include <cstddef>
#include <string>

namespace crossgait {

/// Fits lines into `width` characters. Prose and lists are wrapped between words, below where they began. Of
/// a table (`Table::str`: a header over a rule of dashes) the last column is wrapped if it is of words, else
/// what does not fit stands below, behind the first column again. Words that are longer than a line stay
/// whole, and so does what fits. @param width  at least 20; less is taken as 20
std::string fit_text(const std::string& text, std::size_t width);

}  // namespace crossgait
