// Makes PNG files byte by byte, good and bad, without the library under test.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace crossgait {

enum PngColour : int { kGrey = 0, kColour = 2, kPalette = 3, kGreyAlpha = 4, kColourAlpha = 6 };

struct PngHeader {
  std::uint32_t width = 0, height = 0;
  int depth = 8;
  PngColour colour = kGrey;
  bool interlaced = false;
};

/// Writes four bytes, big-endian.
std::string big_endian(std::uint32_t value);
/// Writes length, type, data and CRC.
std::string png_chunk(std::string_view type, std::string_view data);
/// @param pixels  filter byte and samples of each line, as the PNG specification lays them out
/// @param chunks  whole chunks between IHDR and IDAT
std::string png_file(const PngHeader& header, std::string_view pixels, std::string_view chunks = {});

}  // namespace crossgait
