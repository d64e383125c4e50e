// Grey PNG pictures in memory, through libpng. Private to the terrain part of physics/.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Holds a grey picture and, where the file says so, what it measures.
struct GreyImage {
  int columns = 0, rows = 0;
  std::vector<std::uint16_t> samples;  ///< row-major, top row first
  int white = 65535;                   ///< sample value of white: 255 or 65535

  struct PixelSize {
    double x, y;  ///< m
  };
  struct ValueRange {
    double black, white;  ///< m
  };
  std::optional<PixelSize> pixel_size;    ///< chunk sCAL (PNG 1.2 extensions)
  std::optional<ValueRange> value_range;  ///< chunk pCAL, linear, in m
};

/// Decodes every kind of PNG, interlaced or not. Colours become grey by their luminance (Rec. 709); alpha is
/// ignored and gamma is not applied. Within `kPictureBudget` and kMaxHeightSamples pixels.
/// @param path  for messages
/// @throws ConfigError naming `path` and what was found
GreyImage decode_grey_png(std::string_view bytes, const std::string& path);

/// Encodes 16 bit, with sCAL and pCAL where the image has them. @throws ConfigError
std::string encode_grey_png(const GreyImage& image, const std::string& path);

}  // namespace crossgait
