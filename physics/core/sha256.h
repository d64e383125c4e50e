// SHA-256, by which anybody can check with `sha256sum` what a result was made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace crossgait {

/// Takes bytes in any portions and gives their SHA-256. Source: FIPS 180-4, section 6.2.
class Sha256 {
 public:
  Sha256& add(std::string_view bytes) noexcept;
  /// Writes the hash as 64 hexadecimal digits, of all bytes so far; more may follow.
  std::string hex() const;

 private:
  static constexpr std::size_t kBlock = 64;  // bytes
  void take_block(const std::uint8_t* block) noexcept;

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, kBlock> rest_{};  ///< bytes that fill no block yet
  std::uint64_t size_ = 0;                   ///< bytes so far
};

inline std::string sha256_hex(std::string_view bytes) { return Sha256().add(bytes).hex(); }

}  // namespace crossgait
