#include "physics/robot/contact_json.h"

#include <nlohmann/json.hpp>

namespace crossgait {

nlohmann::ordered_json to_json(const ContactSetting& setting, std::span<const double> numbers) {
  if (!setting.words.empty()) return contact_setting_text(setting, numbers);
  if (numbers.size() == 1) return numbers.front();
  return std::vector(numbers.begin(), numbers.end());
}

}  // namespace crossgait
