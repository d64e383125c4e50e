// What commands write as JSON, as Python's own values: no text in between, and no digit lost.
#pragma once

#include <nanobind/nanobind.h>
#include <nlohmann/json.hpp>

namespace crossgait::python {

inline nanobind::object to_python(const nlohmann::ordered_json& json) {
  namespace nb = nanobind;
  using Type = nlohmann::ordered_json::value_t;
  switch (json.type()) {
    case Type::boolean:
      return nb::bool_(json.get<bool>());
    case Type::number_integer:
      return nb::int_(json.get<std::int64_t>());
    case Type::number_unsigned:
      return nb::int_(json.get<std::uint64_t>());
    case Type::number_float:
      return nb::float_(json.get<double>());
    case Type::string:
      return nb::str(json.get_ref<const std::string&>().c_str());
    case Type::array: {
      nb::list list;
      for (const auto& item : json) list.append(to_python(item));
      return list;
    }
    case Type::object: {
      nb::dict dict;
      for (const auto& [key, value] : json.items()) dict[key.c_str()] = to_python(value);
      return dict;
    }
    default:
      return nb::none();
  }
}

}  // namespace crossgait::python
