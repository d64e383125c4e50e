// Words that docs/words.md retires, looked for in the tree.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait::layering {

/// Reads what docs/words.md lists in backquotes in the first column of its table of retired words.
std::vector<std::string> retired_words(std::string_view words_md);

/// Tells whether `text` holds `word` on its own: no letter, digit or underscore next to an end that is one.
/// @returns the line of the first such place, from 1; 0 if there is none
int line_of_word(std::string_view text, std::string_view word);

struct WordReport {
  std::vector<std::string> found;  ///< "file:line: word"
  int files = 0;                   ///< text files that were read
};

/// Looks for `words` in all code, documents, schemas and scripts of a project at `root`, but for its history
/// (change log, stored results) and for docs/words.md and what tests it.
WordReport find_words(const std::filesystem::path& root, const std::vector<std::string>& words);

/// Finds lines, from 1, whose prose has a number without the zero before its point: ".5 s". Prose is what is
/// outside of code in a document, else what comments say, without quotations.
std::vector<int> bare_decimals(std::string_view text, bool is_document);

/// Looks for such numbers in all documents and headers at `root`, but for its history. @returns "file:line"
WordReport find_bare_decimals(const std::filesystem::path& root);

/// Finds doc comments (`///`) of functions, classes, structs and enums that begin with a preposition or a
/// question word ("Of a robot.", "What a step did."), and so are most often no sentences.
/// @returns their lines, from 1
std::vector<int> verbless_comments(std::string_view header);

/// Looks for such comments in all headers at `root`. @returns "file:line"
WordReport find_verbless_comments(const std::filesystem::path& root);

}  // namespace crossgait::layering
