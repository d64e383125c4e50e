// A YAML text as a tree of nodes, within a budget. Private to yaml_reader.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace crossgait {

/// Holds one value. Aliases share the node that they stand for.
struct YamlNode {
  enum class Kind { kNothing, kScalar, kSequence, kMap };

  Kind kind = Kind::kNothing;
  int line = 1;
  std::size_t values = 1;                              ///< of it and all inside it, aliases written out
  int levels = 0;                                      ///< of sequences and maps inside each other, likewise
  std::string scalar;                                  ///< of a scalar
  std::vector<std::shared_ptr<const YamlNode>> items;  ///< of a sequence or map
  std::vector<std::shared_ptr<const YamlNode>> keys;   ///< of a map, as items
};

/// Reads the one document of a text. @throws ConfigError naming `source` and the line: no YAML, none or
/// several documents, an alias inside its own anchor, or more than `kYamlBudget` allows
std::shared_ptr<const YamlNode> read_yaml(const std::string& text, const std::string& source);

}  // namespace crossgait
