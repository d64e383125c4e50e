#include "policy/tensor_reader.h"

#include <algorithm>
#include <cmath>

#include "physics/core/error.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Index to_index(std::size_t size) { return static_cast<Eigen::Index>(size); }

std::string in_quotes(std::string_view text) { return fmt::format("'{}'", text); }

}  // namespace

void TensorReader::fail(std::string_view element, std::string_view expected, std::string_view found) const {
  throw ConfigError(path_, element, expected, found);
}

void TensorReader::check_format(std::string_view format) {
  if (const std::string found = text("format"); found != format) fail("format", format, in_quotes(found));
}

std::string TensorReader::text(const std::string& key) {
  auto found = find_text(key);
  if (!found) fail(key, fmt::format("metadata of {}", what_), "none");
  return *std::move(found);
}

std::optional<std::string> TensorReader::find_text(const std::string& key) {
  auto entry = file_.metadata.extract(key);
  if (!entry) return std::nullopt;
  return std::move(entry.mapped());
}

double TensorReader::number(const std::string& key) {
  const std::string found = text(key);
  const auto number = parse_number(found);
  if (!number || !std::isfinite(*number)) fail(key, "a finite number", in_quotes(found));
  return *number;
}

double TensorReader::positive_number(const std::string& key) {
  const std::string found = text(key);
  const auto number = parse_number(found);
  if (!number || *number <= 0) fail(key, "a positive number", in_quotes(found));
  return *number;
}

Tensor TensorReader::tensor(const std::string& name, const std::vector<std::size_t>& shape) {
  auto entry = file_.tensors.extract(name);
  if (!entry) fail(name, "this tensor", "none");
  Tensor& found = entry.mapped();
  const auto fits = [](std::size_t size, std::size_t wanted) {
    return wanted == 0 ? size > 0 : size == wanted;
  };
  if (!std::equal(found.shape.begin(), found.shape.end(), shape.begin(), shape.end(), fits)) {
    std::vector<std::string> sizes;
    for (const std::size_t size : shape) sizes.push_back(size == 0 ? "n" : std::to_string(size));
    fail(name, fmt::format("shape [{}]", fmt::join(sizes, ", ")), describe_shape(found.shape));
  }
  const auto bad =
      std::find_if_not(found.values.begin(), found.values.end(), [](double v) { return std::isfinite(v); });
  if (bad != found.values.end())
    fail(name, "finite numbers", fmt::format("{} at {}", *bad, bad - found.values.begin()));
  return std::move(found);
}

Eigen::VectorXd TensorReader::vector(const std::string& name, std::size_t size) {
  const Tensor found = tensor(name, {size});
  return Eigen::Map<const Eigen::VectorXd>(found.values.data(), to_index(found.values.size()));
}

Eigen::MatrixXd TensorReader::matrix(const std::string& name, std::size_t rows, std::size_t columns) {
  const Tensor found = tensor(name, {rows, columns});
  return Eigen::Map<const RowMajor>(found.values.data(), to_index(found.shape[0]), to_index(found.shape[1]));
}

void TensorReader::check_all_read() const {
  if (!file_.tensors.empty()) fail(file_.tensors.begin()->first, "no further tensor", "an unknown one");
  if (!file_.metadata.empty()) fail(file_.metadata.begin()->first, "no further metadata", "an unknown key");
}

}  // namespace crossgait
