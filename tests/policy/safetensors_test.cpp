#include "policy/safetensors.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "physics/core/random.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

constexpr auto kF32 = Tensor::Kind::kF32, kF64 = Tensor::Kind::kF64;

std::string little_endian(std::uint64_t value) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}

std::string with_header(const std::string& header, const std::string& data = "") {
  return little_endian(header.size()) + header + data;
}

TensorFile example() {
  return {
      {{"a", {kF32, {2, 3}, {1, 2, 3, 4, 5, 6}}}, {"b", {kF64, {2}, {-0.5, 1e300}}}, {"c", {kF32, {}, {7}}}},
      {{"made", "by Python"}}};
}

/// What Python's safetensors 0.8.0 writes for `example()`.
std::string example_bytes() {
  const std::string header =
      R"({"__metadata__":{"made":"by Python"},"b":{"dtype":"F64","shape":[2],"data_offsets":[0,16]},)"
      R"("a":{"dtype":"F32","shape":[2,3],"data_offsets":[16,40]},)"
      R"("c":{"dtype":"F32","shape":[],"data_offsets":[40,44]}}      )";
  constexpr char kData[] =
      "\x00\x00\x00\x00\x00\x00\xe0\xbf\x9c\x75\x00\x88\x3c\xe4\x37\x7e\x00\x00\x80\x3f\x00\x00\x00\x40"
      "\x00\x00\x40\x40\x00\x00\x80\x40\x00\x00\xa0\x40\x00\x00\xc0\x40\x00\x00\xe0\x40";
  return with_header(header, {kData, sizeof kData - 1});
}

TEST(Safetensors, ReadsWhatPythonWrites) { EXPECT_EQ(parse_safetensors(example_bytes(), "test"), example()); }

class SafetensorsFile : public ScratchFolder {};

TEST_F(SafetensorsFile, WritesTheSameBytesAsPython) {
  write_safetensors(path("a.safetensors"), example());
  EXPECT_EQ(read(path("a.safetensors")), example_bytes());
  EXPECT_EQ(read_safetensors(path("a.safetensors")), example());
}

TEST_F(SafetensorsFile, KeepsNumbersExactly) {
  using test::kInfinity;
  const TensorFile file{{{"double", {kF64, {4}, {0.1, -0.0, 5e-324, -kInfinity}}},
                         {"empty", {kF64, {0, 3}, {}}},
                         {"float", {kF32, {1, 3}, {0.1F, 1e-45F, kInfinity}}}},
                        {}};
  write_safetensors(path("a"), file);
  EXPECT_EQ(read_safetensors(path("a")), file);
  write_safetensors(path("rounded"), {{{"x", {kF32, {}, {0.1}}}}, {}});
  EXPECT_EQ(read_safetensors(path("rounded")).tensors.at("x").values.front(), 0.1F);
  write_safetensors(path("nan"), {{{"x", {kF64, {}, {std::nan("")}}}}, {}});
  EXPECT_TRUE(std::isnan(read_safetensors(path("nan")).tensors.at("x").values.front()));
  write_safetensors(path("nothing"), {});
  EXPECT_EQ(read_safetensors(path("nothing")), TensorFile{});
}

TEST_F(SafetensorsFile, RefusesToWriteWhatCouldNotBeRead) {
  const auto error_of = [&](const TensorFile& file) {
    const std::string message = config_error([&] { write_safetensors(path("a"), file); }).what();
    EXPECT_FALSE(std::filesystem::exists(path("a")));
    return message.substr(path("a").size());
  };
  EXPECT_EQ(error_of({{{"x", {kF32, {2, 2}, {1, 2, 3}}}}, {}}),
            ": tensor x: expected as many values as [2, 2], found 3");
  EXPECT_EQ(error_of({{{"__metadata__", {kF32, {}, {1}}}}, {}}),
            ": __metadata__: expected another name for a tensor, found this one");
  EXPECT_NE(error_of({{{"\xff", {kF32, {}, {1}}}}, {}}).find("names and metadata: expected UTF-8"),
            std::string::npos);
  EXPECT_NE(error_of({{}, {{"key", "\xff"}}}).find("names and metadata: expected UTF-8"), std::string::npos);
}

struct BadFile {
  const char* name;
  std::string bytes;
  const char* message;  // its beginning
};

void PrintTo(const BadFile& bad, std::ostream* stream) { *stream << bad.name; }

class BadFiles : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadFiles, AreRefused) {
  const std::string message = config_error([] { (void)parse_safetensors(GetParam().bytes, "test"); }).what();
  EXPECT_EQ(message.substr(0, std::string(GetParam().message).size()), GetParam().message);
}

BadFile bad_header(const char* name, const std::string& header, const char* message) {
  return {name, with_header(header, std::string(8, '\0')), message};
}

const std::string kFour = R"("dtype":"F32","shape":[1],"data_offsets":)";

INSTANTIATE_TEST_SUITE_P(
    Safetensors, BadFiles,
    ::testing::Values(
        BadFile{"Empty", "", "test: file: expected at least 8 bytes, found 0"},
        BadFile{"LongHeader", little_endian(5) + "{}",
                "test: header length: expected at most 2 bytes, found 5"},
        BadFile{"EndlessHeader", little_endian(~std::uint64_t{0}) + "{}",
                "test: header length: expected at most 2 bytes, found 18446744073709551615"},
        bad_header("NotAnObject", "[]", "test: header: expected a JSON object, found something else"),
        bad_header("NoJson", "{'a': 1}", "test: header: expected valid JSON, found parse error at line 1"),
        bad_header("NoUtf8", "{\"\xff\": 1}",
                   "test: header: expected valid JSON, found parse error at line 1"),
        bad_header("TwoObjects", "{}{}", "test: header: expected valid JSON"),
        bad_header("ZeroByte", std::string("{}\0}", 4),
                   "test: header: line 1: expected text, found a byte of zero"),
        bad_header("DeepLists", "{\"a\":" + std::string(1'000'000, '['),
                   "test: header: line 1: expected at most 8 levels"),
        bad_header("DeepValue", "{\"a\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}",
                   "test: header: line 1: expected at most 8 levels, found more"),
        bad_header("TensorTwice", "{\"a\":{" + kFour + "[0,4]},\"a\":{" + kFour + "[4,8]}}",
                   "test: header: expected each name once, found 'a' twice"),
        bad_header("KeyTwice", "{\"a\":{\"dtype\":\"F32\"," + kFour + "[0,4]}}",
                   "test: header: expected each name once, found 'dtype' twice"),
        bad_header("MetadataTwice", R"({"__metadata__":{"k":"1","k":"2"}})",
                   "test: header: expected each name once, found 'k' twice"),
        bad_header("MetadataNoText", R"({"__metadata__":{"k":1}})",
                   "test: __metadata__.k: expected a string, found number"),
        bad_header("MetadataNoObject", R"({"__metadata__":"k"})",
                   "test: __metadata__: expected an object, found string"),
        bad_header("UnknownKind", R"({"a":{"dtype":"BF16","shape":[4],"data_offsets":[0,8]}})",
                   "test: tensor a dtype: expected F32 or F64, found BF16"),
        bad_header("KindNoText", R"({"a":{"dtype":32,"shape":[2],"data_offsets":[0,8]}})",
                   "test: tensor a dtype: expected F32 or F64, found number"),
        bad_header("NegativeShape", R"({"a":{"dtype":"F32","shape":[-2,-1],"data_offsets":[0,8]}})",
                   "test: tensor a shape: expected a list of integers of 0 or more, found -2"),
        bad_header("FractionalShape", R"({"a":{"dtype":"F32","shape":[2.0],"data_offsets":[0,8]}})",
                   "test: tensor a shape: expected a list of integers of 0 or more, found 2.0"),
        bad_header("ShapeNoList", R"({"a":{"dtype":"F32","shape":2,"data_offsets":[0,8]}})",
                   "test: tensor a shape: expected a list of integers of 0 or more, found number"),
        bad_header("OverflowingShape",
                   R"({"a":{"dtype":"F32","shape":[4294967296,4294967296,2],"data_offsets":[0,8]}})",
                   "test: tensor a: expected as many bytes as [4294967296, 4294967296, 2] F32 take, found 8"),
        bad_header("WrongShape", R"({"a":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})",
                   "test: tensor a: expected as many bytes as [3] F32 take, found 8"),
        bad_header("HalfAnElement", R"({"a":{"dtype":"F64","shape":[0],"data_offsets":[0,4]}})",
                   "test: tensor a: expected as many bytes as [0] F64 take, found 4"),
        bad_header("BeyondTheEnd", R"({"a":{"dtype":"F32","shape":[3],"data_offsets":[0,12]}})",
                   "test: tensor a data_offsets: expected begin and end within 8 bytes, found [0, 12]"),
        bad_header("Backwards", R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[8,4]}})",
                   "test: tensor a data_offsets: expected begin and end within 8 bytes, found [8, 4]"),
        bad_header("OneOffset", R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[8]}})",
                   "test: tensor a data_offsets: expected begin and end within 8 bytes, found [8]"),
        bad_header("Overlap", "{\"a\":{" + kFour + "[0,4]},\"b\":{" + kFour + "[2,6]}}",
                   "test: tensor b data_offsets: expected to begin at 4, found 2 (an overlap)"),
        bad_header("Gap", "{\"a\":{" + kFour + "[4,8]}}",
                   "test: tensor a data_offsets: expected to begin at 0, found 4 (a gap)"),
        bad_header("LeftOver", "{\"a\":{" + kFour + "[0,4]}}",
                   "test: file: expected 4 bytes of data, found 8"),
        bad_header("FurtherKey", "{\"a\":{\"x\":1," + kFour + "[0,4]}}",
                   "test: tensor a: expected an object of dtype, shape and data_offsets")),
    [](const auto& test) { return test.param.name; });

TEST(Safetensors, TruncatedFilesAreRefused) {
  const std::string bytes = example_bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW((void)parse_safetensors(std::string_view(bytes).substr(0, size), "test"), ConfigError)
        << size;
  }
  EXPECT_THROW((void)parse_safetensors(bytes + " ", "test"), ConfigError);
}

TEST(Safetensors, FlippedBitsAreReadOrRefused) {
  const std::string bytes = example_bytes();
  const std::size_t data = bytes.size() - 44;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
    try {
      EXPECT_FALSE(parse_safetensors(flipped, "test") == example()) << bit;
    } catch (const ConfigError&) {
      EXPECT_LT(bit / 8, data);  // nothing in the data can be wrong in itself
    }
  }
}

}  // namespace
}  // namespace crossgait
