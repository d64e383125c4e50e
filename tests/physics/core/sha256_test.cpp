#include "physics/core/sha256.h"

#include <string>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

// Of FIPS 180-4 (NIST, Examples with Intermediate Values, SHA256.pdf), of its predecessor 180-2, B.3, and of
// nothing (NIST CAVP, SHA256ShortMsg, Len = 0).
TEST(Sha256, IsThatOfItsTestVectors) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, DoesNotHangOnHowBytesArePortioned) {
  // Through 0 to 130 bytes: padding fits the last block or takes one more, and blocks are full or not.
  std::string text;
  for (int size = 0; size <= 130; ++size) {
    const std::string whole = sha256_hex(text);
    for (std::size_t cut = 0; cut <= text.size(); cut += 7) {
      Sha256 parts;
      EXPECT_EQ(parts.add(text.substr(0, cut)).hex(), sha256_hex(text.substr(0, cut)));
      EXPECT_EQ(parts.add(text.substr(cut)).hex(), whole) << size << " bytes, cut at " << cut;
    }
    text += static_cast<char>('a' + size % 26);
  }
}

}  // namespace
}  // namespace crossgait
