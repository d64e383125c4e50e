#include "diagnosis/import_table.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

std::string folder_with(const std::string& table) {
  std::string name = "imported_" + std::to_string(std::hash<std::string>()(table));
  std::filesystem::create_directories(name);
  std::ofstream(name + "/" + name + ".yaml") << "kind: scripted\n";
  if (!table.empty()) std::ofstream(name + "/import.json") << table;
  return name;
}

TEST(UnstatedFields, AreThoseOfTheFoldersTable) {
  const std::string folder = folder_with(R"({"unstated": ["friction", "servos.kp"]})");
  EXPECT_EQ(unstated_fields(folder), (std::vector<std::string>{"friction", "servos.kp"}));
  // The file in the folder is the same policy.
  EXPECT_EQ(unstated_fields(folder + "/" + folder + ".yaml").size(), 2U);
  std::filesystem::remove_all(folder);
}

TEST(UnstatedFields, AreNoneWithoutATable) {
  const std::string folder = folder_with("");
  EXPECT_TRUE(unstated_fields(folder).empty());
  EXPECT_TRUE(unstated_fields("zero").empty());
  std::filesystem::remove_all(folder);
}

TEST(UnstatedFields, OfATableThatIsNoneAreRefused) {
  for (const char* table : {"{}", "[1", R"({"unstated": "friction"})", R"({"unstated": [3]})"}) {
    const std::string folder = folder_with(table);
    EXPECT_THROW(unstated_fields(folder), ConfigError) << table;
    std::filesystem::remove_all(folder);
  }
}

}  // namespace
}  // namespace crossgait
