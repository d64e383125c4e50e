// Hashes by which contents are told apart: not for secrets.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace crossgait {

/// Computes 64-bit FNV-1a, the same on every machine. Source: RFC draft-eastlake-fnv.
class Fnv1a {
 public:
  Fnv1a& add(std::string_view bytes) noexcept {
    for (const char c : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return *this;
  }
  std::uint64_t value() const noexcept { return hash_; }
  /// Writes the hash as 16 hexadecimal digits.
  std::string hex() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

inline std::string fnv1a_hex(std::string_view bytes) { return Fnv1a().add(bytes).hex(); }

}  // namespace crossgait
