#include "python/bindings/batch_parameters.h"

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nlohmann/json.hpp>

#include "physics/engine/world_quantities.h"
#include "physics/robot/contact_json.h"
#include "python/bindings/arrays.h"
#include "python/bindings/inputs.h"
#include "python/bindings/json.h"

namespace crossgait::python {
namespace {

// "friction=0.4", "mass=x1.1", "solref=0.005:1" of a number, a text or a list.
std::string change_text(const std::string& name, nb::handle value) {
  std::string text;
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
    for (const nb::handle number : value)
      text += fmt::format("{}{}", text.empty() ? "" : ":", text_of(nb::str(number), Batch::kSource, name));
  } else {
    text = text_of(nb::str(value), Batch::kSource, name);
  }
  return fmt::format("{}={}", name, text);
}

// As `set_parameters` takes it.
nb::object value_of(const QuantityChange& change) {
  if (change.is_factor) return nb::cast(fmt::format("x{}", change.value.front()));
  if (change.quantity->group == "contact")
    return to_python(to_json(find_contact_setting(change.quantity->name, Batch::kSource), change.value));
  return nb::cast(change.value.front());
}

}  // namespace

void set_parameters(Batch& batch, const nb::dict& parameters, const Indices& indices) {
  const std::vector<std::size_t> which = chosen(batch, indices);
  for (std::size_t k = 0; k < which.size(); ++k) {
    std::vector<QuantityChange> changes(batch.at(which[k]).changes().begin(),
                                        batch.at(which[k]).changes().end());
    for (const auto& [key, given] : parameters) {
      const std::string name = text_of(nb::str(key), Batch::kSource, "parameters");
      const WorldQuantity& quantity = find_world_quantity(name, Batch::kSource);
      std::erase_if(changes, [&](const QuantityChange& c) { return c.quantity == &quantity; });
      if (given.is_none()) continue;
      nb::object value = nb::borrow(given);
      // Tensors of learners, too. A list is several numbers of one setting of contact, or one for each.
      const bool is_list = nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value);
      if (nb::hasattr(value, "__array__") || (is_list && quantity.group != "contact")) {
        const auto each = numbers_of(value);
        const bool is_one = nb::cast<int>(nb::getattr(value, "ndim", nb::cast(1))) == 0;
        if (!is_one && (each.ndim() != 1 || each.size() != which.size()))
          throw ConfigError(Batch::kSource, name,
                            fmt::format("an array of one number for each of {}", which.size()),
                            fmt::format("{}", each.size()));
        value = nb::cast(each.data()[is_one ? 0 : k]);
      }
      changes.push_back(parse_quantity_change(change_text(name, value), Batch::kSource));
    }
    batch.change(which[k]).set_changes(std::move(changes));
  }
}

nb::list parameters_of(const Batch& batch) {
  nb::list all;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    nb::dict one;
    for (const QuantityChange& change : batch.at(i).changes())
      one[change.quantity->name.c_str()] = value_of(change);
    all.append(one);
  }
  return all;
}

}  // namespace crossgait::python
