#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "physics/terrain/grey_png.h"
#include "physics/terrain/terrain.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/terrain/png_bytes.h"

namespace crossgait {
namespace {

/// Heights without any order, some of them negative, on cells that are not square.
HeightField noise(int columns, int rows) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> height(-0.03F, 0.07F);
  std::vector<float> heights(static_cast<std::size_t>(columns * rows));
  for (float& value : heights) value = height(generator);
  return {columns, rows, 1.7, 0.9, heights};
}

std::string load_error(const std::string& text) {
  return config_error([&] { make_terrain(text); }).what();
}

std::vector<float> heights(const Terrain& terrain) {
  return {terrain.field()->heights().begin(), terrain.field()->heights().end()};
}

class TerrainPng : public ScratchFolder {
 protected:
  /// Loads a file of these bytes. `keys` as in ":z_max=1".
  Terrain load(std::string_view bytes, const std::string& keys = "") const {
    return make_terrain(write("map.png", bytes) + keys);
  }
  /// What loading is answered with, less the path.
  std::string error(std::string_view bytes, const std::string& keys = "") const {
    const std::string what = load_error(write("map.png", bytes) + keys);
    const std::string prefix = path("map.png") + ": ";
    EXPECT_TRUE(what.starts_with(prefix)) << what;
    return what.substr(prefix.size());
  }
};

/// Three by two: the upper line 255 0 51, the lower 102 153 204.
std::string small_picture() { return png_file({3, 2}, std::string("\0\xff\0\x33\0\x66\x99\xcc", 8)); }

/// Heights are rounded to a 24th bit of the largest.
void expect_heights(const Terrain& terrain, const std::vector<float>& expected) {
  const std::vector<float> found = heights(terrain);
  ASSERT_EQ(found.size(), expected.size());
  const double largest = std::abs(*std::max_element(
      expected.begin(), expected.end(), [](float a, float b) { return std::abs(a) < std::abs(b); }));
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 2.4e-7 * largest);
}

TEST_F(TerrainPng, ReadsEightBits) {
  const Terrain terrain = load(small_picture());
  EXPECT_EQ(terrain.name(), path("map.png"));
  const HeightField& field = *terrain.field();
  EXPECT_EQ(field.columns(), 3);
  EXPECT_EQ(field.rows(), 2);
  EXPECT_EQ(field.size_x(), 2 * 0.025);
  EXPECT_EQ(field.size_y(), 1 * 0.025);
  // The lower line has the smaller y; 255 is 0.05 m.
  expect_heights(terrain, {0.02F, 0.03F, 0.04F, 0.05F, 0, 0.01F});
}

TEST_F(TerrainPng, ReadsSixteenBits) {
  PngHeader header{2, 2};
  header.depth = 16;
  const std::string pixels("\0\0\xff\xff\0\0\x80\0\0\x01", 10);
  const Terrain terrain = load(png_file(header, pixels), ":z_min=-100,z_max=555.35,size_x=3,size_y=4");
  const std::vector<double> expected{0x8000 / 100.0 - 100, 0x0001 / 100.0 - 100, 0x00ff / 100.0 - 100,
                                     0xff00 / 100.0 - 100};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(heights(terrain)[i], expected[i], 3e-5);  // floats
  EXPECT_EQ(terrain.field()->size_x(), 3);
  EXPECT_EQ(terrain.field()->size_y(), 4);
}

TEST_F(TerrainPng, ReadsInterlacedPictures) {
  PngHeader header{2, 2};
  header.interlaced = true;
  // Adam7 of two by two: pass 1 has the upper left pixel, pass 6 the upper right, pass 7 the lower line.
  const std::string pixels("\0\x33\0\x66\0\x99\xcc", 7);
  expect_heights(load(png_file(header, pixels)), {0.03F, 0.04F, 0.01F, 0.02F});
}

TEST_F(TerrainPng, ReadsUpperCaseNames) {
  EXPECT_EQ(make_terrain(write("MAP.PNG", small_picture())).field()->columns(), 3);
  EXPECT_EQ(make_terrain(write("a:b=c.png", small_picture()) + ":z_max=1").field()->max(), 1);
}

TEST_F(TerrainPng, TakesTheScaleFromTheFile) {
  using std::string_literals::operator""s;
  const PngHeader header{3, 2};
  const std::string pixels("\0\xff\0\x33\0\x66\x99\xcc", 8);
  // sCAL: metres, width and height of a pixel. pCAL: name, x0, x1, linear, two parameters, unit and both of
  // them.
  const auto with = [&](const std::string& scal, const std::string& pcal) {
    return png_file(header, pixels, png_chunk("sCAL", scal) + png_chunk("pCAL", pcal));
  };
  const std::string metres =
      "\x01"
      "0.5\0"
      "0.25"s;
  const std::string range =
      "height\0"s + big_endian(0) + big_endian(255) + "\0\x02"s + "m\0"s + "-1\0"s + "3";
  const Terrain terrain = load(with(metres, range));
  EXPECT_EQ(terrain.field()->size_x(), 1);
  EXPECT_EQ(terrain.field()->size_y(), 0.25);
  EXPECT_EQ(terrain.field()->min(), -1);
  EXPECT_EQ(terrain.field()->max(), 2);
  // Keys go before it.
  EXPECT_EQ(load(with(metres, range), ":z_max=5").field()->max(), 5);
  EXPECT_EQ(load(with(metres, range), ":size_y=7").field()->size_y(), 7);
  // Radians are no metres, and a temperature is no height.
  const std::string radians =
      "\x02"
      "0.5\0"
      "0.25"s;
  const std::string kelvin = "heat\0"s + big_endian(0) + big_endian(255) + "\0\x02"s + "K\0"s + "-1\0"s + "3";
  EXPECT_EQ(load(with(radians, kelvin)).field()->size_x(), 0.05);
  EXPECT_EQ(load(with(radians, kelvin)).field()->max(), static_cast<double>(0.05F));
}

TEST_F(TerrainPng, RefusesAScaleBeyondReason) {
  using std::string_literals::operator""s;
  const std::string pcal =
      "height\0"s + big_endian(0) + big_endian(255) + "\0\x02"s + "m\0"s + "0\0"s + "1e300";
  EXPECT_EQ(error(png_file({2, 2}, std::string(6, '\0'), png_chunk("pCAL", pcal))),
            "pCAL: expected heights in [-10000, 10000] m, found 0 to 1e+300 m");
}

TEST_F(TerrainPng, AppliesNoGamma) {
  const std::string gamma = png_chunk("gAMA", big_endian(45455));
  EXPECT_EQ(heights(load(png_file({3, 2}, std::string("\0\xff\0\x33\0\x66\x99\xcc", 8), gamma))),
            heights(load(small_picture())));
}

TEST_F(TerrainPng, GivesBackWhatWasWritten) {
  const HeightField field = noise(23, 17);
  write_png(field, path("out.png"));
  const Terrain terrain = make_terrain(path("out.png"));
  ASSERT_EQ(terrain.field()->columns(), 23);
  ASSERT_EQ(terrain.field()->rows(), 17);
  EXPECT_NEAR(terrain.field()->size_x(), 1.7, 1e-15);  // rounding of 22 * (1.7 / 22)
  EXPECT_NEAR(terrain.field()->size_y(), 0.9, 1e-15);
  EXPECT_EQ(terrain.field()->min(), field.min());
  EXPECT_EQ(terrain.field()->max(), field.max());
  const double half_level = (field.max() - field.min()) / 65535 / 2;
  double largest = 0;
  for (int r = 0; r < 17; ++r) {
    for (int c = 0; c < 23; ++c)
      largest = std::max(largest, std::abs(terrain.field()->at(c, r) - field.at(c, r)));
  }
  EXPECT_LE(largest, half_level + 4e-9);  // and the rounding to float of 0.07 m
  EXPECT_GT(largest, half_level / 2) << "16 bits round; nothing else is being compared";
}

TEST_F(TerrainPng, GivesBackALevelField) {
  write_png(HeightField(3, 3, 1, 1, std::vector<float>(9, -0.5F)), path("out.png"));
  EXPECT_EQ(heights(make_terrain(path("out.png"))), std::vector<float>(9, -0.5F));
}

TEST_F(TerrainPng, TakesColoursByTheirLuminance) {
  // The lower line, white and black, then the upper, red and green; :z_max=1 makes the luminance the height.
  const std::vector<float> expected{1, 0, 0.2126F, 0.7152F};
  const auto picture = [&](PngColour colour, int depth, const std::string& pixels,
                           const std::string& chunks = "") {
    PngHeader header{2, 2};
    header.colour = colour;
    header.depth = depth;
    return heights(load(png_file(header, pixels, chunks), ":z_max=1"));
  };
  const auto expect = [](const std::vector<float>& found, const std::vector<float>& wanted) {
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
      EXPECT_NEAR(found[i], wanted[i], 0.51 / 65535) << i;  // a sample
  };
  const auto bytes = [](std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) text += static_cast<char>(value);
    return text;
  };
  const auto doubled = [](const std::string& lines,
                          std::size_t line) {  // 8 bits to 16, filter bytes as they are
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i) text += std::string(i % line == 0 ? 1 : 2, lines[i]);
    return text;
  };
  const std::string rgb = bytes({0, 255, 0, 0, 0, 255, 0, 0, 255, 255, 255, 0, 0, 0});
  expect(picture(kColour, 8, rgb), expected);
  expect(picture(kColour, 16, doubled(rgb, 7)), expected);
  const std::string rgba = bytes({0, 255, 0, 0, 7, 0, 255, 0, 8, 0, 255, 255, 255, 0, 0, 0, 0, 255});
  expect(picture(kColourAlpha, 8, rgba), expected);
  expect(picture(kColourAlpha, 16, doubled(rgba, 9)), expected);
  const std::string palette = png_chunk("PLTE", bytes({255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0}));
  expect(picture(kPalette, 8, bytes({0, 2, 3, 0, 0, 1}), palette), expected);
  expect(picture(kPalette, 2, bytes({0, 0xb0, 0, 0x10}), palette), expected);
  // Grey with alpha, and with fewer bits.
  expect(picture(kGreyAlpha, 8, bytes({0, 51, 0, 102, 9, 0, 255, 1, 0, 2})), {1, 0, 0.2F, 0.4F});
  expect(picture(kGrey, 4, bytes({0, 0x36, 0, 0xf0})), {1, 0, 0.2F, 0.4F});
}

TEST_F(TerrainPng, SaysWhichScaleItTook) {
  EXPECT_EQ(
      load(small_picture()).scale(),
      "size_x 0.05 m (assumed), size_y 0.025 m (assumed), z_min (black) 0 m (assumed), z_max (white) 0.05 m "
      "(assumed)");
  write_png(noise(3, 3), path("own.png"));
  EXPECT_EQ(make_terrain(path("own.png") + ":size_x=4").scale().substr(0, 52),
            "size_x 4 m (given), size_y 0.9 m (from the file), z_");
  EXPECT_EQ(make_terrain("rough").scale(), "");
}

// A text chunk of a few kilobytes unfolds to megabytes, and there may be a thousand.
TEST_F(TerrainPng, PassesOverWhatStandsBesideThePixels) {
  const std::string broken =
      png_chunk("zTXt", std::string("a\0\0no zlib stream", 17)) + png_chunk("iCCP", "damaged");
  EXPECT_EQ(heights(load(png_file({3, 2}, std::string("\0\xff\0\x33\0\x66\x99\xcc", 8), broken))),
            heights(load(small_picture())));
}

TEST_F(TerrainPng, RefusesTooFewAndTooManyPixels) {
  EXPECT_EQ(error(png_file({1, 2}, std::string(4, '\0'))),
            "columns: expected at least 2 samples along x, found 1");
  EXPECT_EQ(error(png_file({2, 1}, std::string(3, '\0'))),
            "rows: expected at least 2 samples along y, found 1");
  EXPECT_EQ(error(png_file({100000, 100000}, "")),
            "picture: expected at most 16777216 pixels, found 100000 x 100000");
}

TEST_F(TerrainPng, RefusesOtherFiles) {
  EXPECT_EQ(error(""), "file: expected a PNG picture, found an empty file");
  EXPECT_EQ(error("P5 2 2 255 "),
            "file: expected a PNG picture, found other content, beginning with 'P5 2 2 2'");
  EXPECT_EQ(config_error([&] { make_terrain(path("none.png")); }).source(), path("none.png"));
  std::filesystem::create_directory(path("folder.png"));
  EXPECT_EQ(config_error([&] { make_terrain(path("folder.png")); }).source(), path("folder.png"));
}

TEST_F(TerrainPng, RefusesEveryTruncationQuietly) {
  const std::string whole = small_picture();
  EXPECT_EQ(error(whole.substr(0, whole.size() - 20)),
            "file: expected a whole and valid PNG picture, found one that ends early");
  ::testing::internal::CaptureStderr();
  for (std::size_t size = 8; size < whole.size(); ++size) {
    const ConfigError error =
        config_error([&] { decode_grey_png(std::string_view(whole).substr(0, size), "map.png"); });
    ASSERT_EQ(error.expected(), "a whole and valid PNG picture") << size;
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(TerrainPng, RefusesEveryDamage) {
  write_png(noise(9, 7), path("good.png"));
  const std::string good = read(path("good.png"));
  std::mt19937 generator(12);
  for (std::size_t i = 0; i < good.size(); ++i) {  // every byte is under a checksum
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ (1 + generator() % 255));
    ASSERT_EQ(config_error([&] { decode_grey_png(bytes, "map.png"); }).source(), "map.png") << i;
  }
}

TEST_F(TerrainPng, RefusesWrongKeys) {
  EXPECT_EQ(error(small_picture(), ":cell=1"),
            "parameters: expected one of size_x, size_y, z_min, z_max, found 'cell'");
  EXPECT_EQ(error(small_picture(), ":z_min=.1"), "z_max: expected at least z_min, 0.1 m, found 0.05 m");
  EXPECT_EQ(error(small_picture(), ":size_x=0"), "size_x: expected a number in [0.001, 10000] m, found '0'");
}

class TerrainCsv : public ScratchFolder {
 protected:
  Terrain load(std::string_view text, const std::string& keys = "") const {
    return make_terrain(write("map.csv", text) + keys);
  }
  std::string error(std::string_view text, const std::string& keys = "") const {
    const std::string what = load_error(write("map.csv", text) + keys);
    const std::string prefix = path("map.csv") + ": ";
    EXPECT_TRUE(what.starts_with(prefix)) << what;
    return what.substr(prefix.size());
  }
};

TEST_F(TerrainCsv, ReadsMetresFromTheLargestY) {
  const Terrain terrain = load("0.5,-1,.25\n1e-3,2,3\n");
  expect_heights(terrain, {0.001F, 2, 3, 0.5F, -1, 0.25F});
  EXPECT_EQ(terrain.field()->size_x(), 0.05);
  EXPECT_EQ(terrain.field()->size_y(), 0.025);
  EXPECT_EQ(load("1,2\n3,4\n", ":size_x=5").field()->size_x(), 5);
}

TEST_F(TerrainCsv, ReadsWhatSpreadsheetsWrite) {
  const std::vector<float> expected{3, 4, 1, 2};
  EXPECT_EQ(heights(load("1,2\n3,4")), expected) << "no newline at the end";
  EXPECT_EQ(heights(load("1,2\r\n3,4\r\n")), expected);
  EXPECT_EQ(heights(load("\xef\xbb\xbf"
                         "1, 2\n\t3 ,4\n")),
            expected);
}

TEST_F(TerrainCsv, GivesBackTheSameFloats) {
  HeightField field = noise(23, 17);
  write_csv(field, path("out.csv"));
  const Terrain terrain = make_terrain(path("out.csv") + ":size_x=1.7,size_y=.9");
  EXPECT_EQ(heights(terrain), std::vector<float>(field.heights().begin(), field.heights().end()));
  EXPECT_EQ(terrain.field()->size_x(), 1.7);
  const HeightField extremes(2, 2, 1, 1, {1e-45F, -9999.999F, -0.0F, 1.00000012F});
  write_csv(extremes, path("extremes.csv"));
  EXPECT_EQ(heights(make_terrain(path("extremes.csv"))),
            std::vector<float>(extremes.heights().begin(), extremes.heights().end()));
}

TEST_F(TerrainCsv, NamesLineAndColumn) {
  EXPECT_EQ(error(""), "line 1: expected comma-separated heights in m, found an empty file");
  EXPECT_EQ(error("1,2\n3\n"), "line 2: expected 2 values, as in line 1, found 1");
  EXPECT_EQ(error("1,2\n3,4,5\n"), "line 2: expected 2 values, as in line 1, found 3");
  EXPECT_EQ(error("1,2\n3,nan\n"), "line 2, column 2: expected a height in [-10000, 10000] m, found 'nan'");
  EXPECT_EQ(error("1,2\n-inf,4\n"), "line 2, column 1: expected a height in [-10000, 10000] m, found '-inf'");
  EXPECT_EQ(error("x,y\n3,4\n"), "line 1, column 1: expected a height in [-10000, 10000] m, found 'x'");
  EXPECT_EQ(error("1,2\n3,\n"), "line 2, column 2: expected a height in [-10000, 10000] m, found nothing");
  EXPECT_EQ(error("1,2\n\n3,4\n"), "line 2, column 1: expected a height in [-10000, 10000] m, found nothing");
  EXPECT_EQ(error("1;2\n3;4\n"), "line 1, column 1: expected a height in [-10000, 10000] m, found '1;2'");
  EXPECT_EQ(error("1,10001\n3,4\n"),
            "line 1, column 2: expected a height in [-10000, 10000] m, found '10001'");
  EXPECT_EQ(error(std::string("1,2\n3,\0004\n", 9)),
            "line 2, column 2: expected a height in [-10000, 10000] m, found '\\x004'");
  EXPECT_EQ(error("7\n"), "columns: expected at least 2 samples along x, found 1");
  EXPECT_EQ(error("7,8\n"), "rows: expected at least 2 samples along y, found 1");
  EXPECT_EQ(error("1,2\n3,4\n", ":z_max=1"), "parameters: expected one of size_x, size_y, found 'z_max'");
  EXPECT_EQ(config_error([&] { make_terrain(path("none.csv")); }).source(), path("none.csv"));
}

class TerrainFiles : public ScratchFolder {};

TEST_F(TerrainFiles, AreNotWrittenWhereTheyCannotBe) {
  const HeightField field = noise(2, 2);
  EXPECT_EQ(config_error([&] { write_png(field, path("none/out.png")); }).source(), path("none/out.png"));
  EXPECT_EQ(config_error([&] { write_csv(field, path("none/out.csv")); }).source(), path("none/out.csv"));
}

TEST_F(TerrainFiles, ExamplesAreWhatTheirReadmeSays) {
  const std::string folder = CROSSGAIT_SOURCE_DIR "/models/terrains/";
  const Terrain bumps = make_terrain(folder + "bumps.png");
  const Terrain made = make_terrain("rough:size_x=4,size_y=2,amplitude=.02,seed=7");
  ASSERT_EQ(bumps.field()->heights().size(), made.field()->heights().size());
  for (int i = -19; i < 20; ++i) {
    // At samples; half a grey level of at most 0.04 m.
    EXPECT_NEAR(bumps.height(0.1 * i, 0.05 * i), made.height(0.1 * i, 0.05 * i), 0.04 / 65535);
  }
  EXPECT_EQ(heights(make_terrain(folder + "blocks.csv")),
            heights(make_terrain("steps:size_x=1.5,size_y=1,seed=7")));
}

}  // namespace
}  // namespace crossgait
