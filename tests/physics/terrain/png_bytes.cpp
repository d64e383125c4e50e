#include "tests/physics/terrain/png_bytes.h"

namespace crossgait {
namespace {

/// PNG specification, annex D.
std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~crc;
}

/// One stored block (RFC 1951, section 3.2.4; up to 65535 bytes) in a zlib stream (RFC 1950).
std::string zlib_stored(std::string_view bytes) {
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char byte : bytes) {
    a = (a + static_cast<unsigned char>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  const auto size = static_cast<std::uint32_t>(bytes.size());
  const auto little_endian = [](std::uint32_t value) {
    return std::string{static_cast<char>(value & 0xffU), static_cast<char>(value >> 8U & 0xffU)};
  };
  return "\x78\x01\x01" + little_endian(size) + little_endian(~size) + std::string(bytes) +
         big_endian(b << 16U | a);
}

}  // namespace

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(value >> shift & 0xffU);
  return bytes;
}

std::string png_chunk(std::string_view type, std::string_view data) {
  const std::string body = std::string(type) + std::string(data);
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(crc32(body));
}

std::string png_file(const PngHeader& header, std::string_view pixels, std::string_view chunks) {
  std::string ihdr = big_endian(header.width) + big_endian(header.height);
  for (const int byte : {header.depth, static_cast<int>(header.colour), 0, 0, header.interlaced ? 1 : 0}) {
    ihdr += static_cast<char>(byte);
  }
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", ihdr) + std::string(chunks) +
         png_chunk("IDAT", zlib_stored(pixels)) + png_chunk("IEND", "");
}

}  // namespace crossgait
