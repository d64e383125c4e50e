#include "physics/terrain/grey_png.h"

#include <array>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <new>

#include <fmt/format.h>
#include <png.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/terrain/terrain_parameters.h"

namespace crossgait {
namespace {

/// libpng reports errors by longjmp, which must not jump over destructors: every object lives outside of
/// `attempt`, and the actions given to it own nothing.
template <typename Action>
bool attempt(png_structp png, const Action& action) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  action();
  return true;
}

void on_error(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}

/// Warnings are of chunks that a height field has no use for; libpng would print them.
void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}

struct Reader {
  explicit Reader(std::string_view bytes) : rest(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, on_error, on_warning);
    info = png ? png_create_info_struct(png) : nullptr;
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(const Reader&) = delete;
  Reader(Reader&&) = delete;
  Reader& operator=(const Reader&) = delete;
  Reader& operator=(Reader&&) = delete;

  std::string_view rest;
  std::string message;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

struct Writer {
  Writer() {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, on_error, on_warning);
    info = png ? png_create_info_struct(png) : nullptr;
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer(Writer&&) = delete;
  Writer& operator=(const Writer&) = delete;
  Writer& operator=(Writer&&) = delete;

  std::string bytes;
  std::string message;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

constexpr const char* kEndsEarly = "one that ends early";
constexpr std::size_t kSignature = 8;  ///< bytes before the first chunk

/// Whether every chunk is as long as it says. libpng would find out after clearing the memory for it, up to 2
/// GiB.
bool has_whole_chunks(std::string_view bytes) {
  constexpr std::size_t kFrame = 12;  // length, type and checksum
  bytes.remove_prefix(kSignature);
  while (bytes.size() >= kFrame) {
    std::size_t length = 0;
    for (const char byte : bytes.substr(0, 4)) length = length << 8U | static_cast<unsigned char>(byte);
    if (length > bytes.size() - kFrame) return false;
    if (bytes.substr(4, 4) == "IEND") return true;
    bytes.remove_prefix(kFrame + length);
  }
  return false;
}

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
  std::string_view& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (rest.size() < count) png_error(png, kEndsEarly);
  std::memcpy(out, rest.data(), count);
  rest.remove_prefix(count);
}

void write_bytes(png_structp png, png_bytep data, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), count);
}

void flush_nothing(png_structp /*png*/) {}

void check_size(const Reader& reader, const std::string& path) {
  const std::int64_t columns = png_get_image_width(reader.png, reader.info);
  const std::int64_t rows = png_get_image_height(reader.png, reader.info);
  if (columns > kMaxHeightSamples / rows) {
    throw ConfigError(path, "picture", fmt::format("at most {} pixels", kMaxHeightSamples),
                      fmt::format("{} x {}", columns, rows));
  }
}

/// Every kind of pixel as one or three samples of 8 or 16 bits, without alpha.
void unify_pixels(const Reader& reader) {
  const int depth = png_get_bit_depth(reader.png, reader.info);
  const int colour_type = png_get_color_type(reader.png, reader.info);
  if (colour_type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(reader.png);
  if (colour_type == PNG_COLOR_TYPE_GRAY && depth < 8) png_set_expand_gray_1_2_4_to_8(reader.png);
  png_set_strip_alpha(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
}

/// Samples of `pixels` (row-major, of one or three channels of 8 or 16 bits, big-endian), grey of the given
/// white. Colours by their luminance, weighted as Recommendation ITU-R BT.709-6 (section 3.2) says, on the
/// stored values: gamma is not applied to grey either.
std::vector<std::uint16_t> to_grey(const std::vector<png_byte>& pixels, std::size_t channels, bool wide,
                                   int white) {
  const auto sample = [&](std::size_t index) {
    return wide ? pixels[2 * index] << 8U | pixels[2 * index + 1] : pixels[index];
  };
  const std::size_t count = pixels.size() / channels / (wide ? 2 : 1);
  const double scale = static_cast<double>(white) / (wide ? 65535 : 255);
  std::vector<std::uint16_t> grey;
  grey.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (channels == 1) {
      grey.push_back(static_cast<std::uint16_t>(sample(i)));
    } else {
      const double luminance =
          0.2126 * sample(3 * i) + 0.7152 * sample(3 * i + 1) + 0.0722 * sample(3 * i + 2);
      grey.push_back(static_cast<std::uint16_t>(std::lround(scale * luminance)));
    }
  }
  return grey;
}

/// Chunks of other units or equations say nothing about heights in m and are passed over.
/// @param largest  what a sample of the file can be at most
void read_scales(const Reader& reader, int largest, GreyImage& image) {
  int unit = 0;
  png_charp width = nullptr;
  png_charp height = nullptr;
  if (png_get_sCAL_s(reader.png, reader.info, &unit, &width, &height) != 0 && unit == PNG_SCALE_METER) {
    const auto x = parse_number(width);
    const auto y = parse_number(height);
    if (x && y) image.pixel_size = {*x, *y};
  }
  png_charp purpose = nullptr;
  png_charp units = nullptr;
  png_charpp parameters = nullptr;
  png_int_32 first = 0;
  png_int_32 last = 0;
  int equation = 0;
  int count = 0;
  if (png_get_pCAL(reader.png, reader.info, &purpose, &first, &last, &equation, &count, &units,
                   &parameters) != 0 &&
      equation == PNG_EQUATION_LINEAR && count == 2 && first == 0 && last == largest &&
      std::strcmp(units, "m") == 0) {
    const auto black = parse_number(parameters[0]);
    const auto span = parse_number(parameters[1]);
    if (black && span) image.value_range = {*black, *black + *span};
  }
}

/// Numbers as sCAL and pCAL hold them: in text.
struct ScaleText {
  explicit ScaleText(const GreyImage& image) {
    if (image.pixel_size) {
      pixel_x = fmt::format("{}", image.pixel_size->x);
      pixel_y = fmt::format("{}", image.pixel_size->y);
    }
    if (image.value_range) {
      black = fmt::format("{}", image.value_range->black);
      span = fmt::format("{}", image.value_range->white - image.value_range->black);
    }
  }

  std::string pixel_x, pixel_y, black, span;
};

}  // namespace

GreyImage decode_grey_png(std::string_view bytes, const std::string& path) {
  if (bytes.size() < kSignature ||
      png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, kSignature) != 0) {
    throw ConfigError(
        path, "file", "a PNG picture",
        bytes.empty() ? "an empty file" : "other content, beginning with " + quoted(bytes.substr(0, 8)));
  }
  Reader reader(bytes);
  if (!reader.info) throw std::bad_alloc();
  const auto* scale_chunks = reinterpret_cast<png_const_bytep>("sCAL\0pCAL");
  const auto fail = [&] { throw ConfigError(path, "file", "a whole and valid PNG picture", reader.message); };
  if (!has_whole_chunks(bytes)) {
    reader.message = kEndsEarly;
    fail();
  }
  if (!attempt(reader.png, [&] {
        png_set_read_fn(reader.png, &reader.rest, read_bytes);
        // Of what may stand beside the pixels only the scales are looked at: texts and profiles are
        // compressed, and a thousand of them may unfold to gigabytes.
        png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
        png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_AS_DEFAULT, scale_chunks, 2);
        // A damaged scale must not pass for a missing one.
        png_set_crc_action(reader.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
        png_read_info(reader.png, reader.info);
      })) {
    fail();
  }
  check_size(reader, path);

  GreyImage image;
  const int largest = (1 << png_get_bit_depth(reader.png, reader.info)) - 1;
  const bool palette = png_get_color_type(reader.png, reader.info) == PNG_COLOR_TYPE_PALETTE;
  image.columns = static_cast<int>(png_get_image_width(reader.png, reader.info));
  image.rows = static_cast<int>(png_get_image_height(reader.png, reader.info));
  std::vector<png_byte> pixels;
  std::vector<png_bytep> rows;
  if (!attempt(reader.png, [&] { unify_pixels(reader); })) fail();
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  pixels.resize(row_bytes * static_cast<std::size_t>(image.rows));
  for (std::size_t at = 0; at < pixels.size(); at += row_bytes) rows.push_back(&pixels[at]);
  if (!attempt(reader.png, [&] {
        png_read_image(reader.png, rows.data());
        png_read_end(reader.png, reader.info);
      })) {
    fail();
  }
  read_scales(reader, palette ? 0 : largest, image);  // what pCAL says of a palette is of its indices
  const std::size_t channels = png_get_channels(reader.png, reader.info);
  const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
  // The luminance of three samples of 8 bits lies between two of them.
  image.white = wide || channels == 3 ? 65535 : 255;
  image.samples = to_grey(pixels, channels, wide, image.white);
  return image;
}

std::string encode_grey_png(const GreyImage& image, const std::string& path) {
  std::vector<png_byte> pixels;
  pixels.reserve(2 * image.samples.size());
  for (const std::uint16_t sample : image.samples) {  // big-endian
    pixels.push_back(static_cast<png_byte>(sample >> 8U));
    pixels.push_back(static_cast<png_byte>(sample & 0xffU));
  }
  std::vector<png_bytep> rows;
  const std::size_t row_bytes = 2 * static_cast<std::size_t>(image.columns);
  for (std::size_t at = 0; at < pixels.size(); at += row_bytes) rows.push_back(&pixels[at]);
  ScaleText text(image);
  std::array<char*, 2> line{text.black.data(), text.span.data()};

  Writer writer;
  if (!writer.info) throw std::bad_alloc();
  if (!attempt(writer.png, [&] {
        png_set_write_fn(writer.png, &writer.bytes, write_bytes, flush_nothing);
        png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.columns),
                     static_cast<png_uint_32>(image.rows), 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        if (image.pixel_size) {
          png_set_sCAL_s(writer.png, writer.info, PNG_SCALE_METER, text.pixel_x.c_str(),
                         text.pixel_y.c_str());
        }
        if (image.value_range) {
          png_set_pCAL(writer.png, writer.info, "height", 0, 65535, PNG_EQUATION_LINEAR, 2, "m", line.data());
        }
        png_set_rows(writer.png, writer.info, rows.data());
        png_write_png(writer.png, writer.info, PNG_TRANSFORM_IDENTITY, nullptr);
      })) {
    throw ConfigError(path, "picture", "a size that PNG can hold",
                      fmt::format("{} x {} ({})", image.columns, image.rows, writer.message));
  }
  return writer.bytes;
}

}  // namespace crossgait
