// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/edid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama::output {
namespace {

using ::testing::HasSubstr;

std::vector<std::uint8_t> with_checksum(std::vector<std::uint8_t> bytes) {
  bytes[127] = 0;
  bytes[127] = static_cast<std::uint8_t>(256 - std::accumulate(bytes.begin(), bytes.begin() + 128, 0) % 256);
  return bytes;
}

TEST(Edid, names_the_projector_and_its_colour_depth) {
  const auto edid = parse_edid(fake_edid("EB-L1755U", 10));
  ASSERT_TRUE(edid) << edid.error().message();
  EXPECT_EQ(edid->maker, "CYC");
  EXPECT_EQ(edid->model, "EB-L1755U");
  EXPECT_EQ(edid->product, 0x1234);
  EXPECT_EQ(edid->colour_bits, 10);
  EXPECT_EQ(edid->text(), "CYC EB-L1755U");
}

TEST(Edid, reads_every_depth_and_a_missing_one) {
  for (const int bits : {0, 6, 8, 10, 12, 14, 16}) EXPECT_EQ(parse_edid(fake_edid("x", bits))->colour_bits, bits);
  std::vector<std::uint8_t> older = fake_edid("x", 10);
  older[19] = 3;  // Version 1.3 has no such field.
  EXPECT_EQ(parse_edid(with_checksum(older))->colour_bits, 0);
  std::vector<std::uint8_t> analogue = fake_edid("x", 10);
  analogue[20] = 0x3f;
  EXPECT_EQ(parse_edid(with_checksum(analogue))->colour_bits, 0);
}

TEST(Edid, returns_printable_text_for_any_bytes) {
  std::vector<std::uint8_t> bytes = fake_edid("x", 8);
  bytes[8] = bytes[9] = 0xff;
  for (std::size_t i = 0; i < 13; ++i) bytes[54 + 5 + i] = 0x1b;
  const auto edid = parse_edid(with_checksum(bytes));
  ASSERT_TRUE(edid);
  EXPECT_EQ(edid->maker, "???");
  EXPECT_EQ(edid->model, "?????????????");
}

TEST(Edid, names_the_product_if_there_is_no_model) {
  std::vector<std::uint8_t> bytes = fake_edid("x", 8);
  bytes[54 + 3] = 0x10;
  EXPECT_EQ(parse_edid(with_checksum(bytes))->text(), "CYC 1234");
}

TEST(Edid, refuses_invalid_data) {
  const auto message_of = [](const std::vector<std::uint8_t>& bytes) {
    const auto edid = parse_edid(bytes);
    EXPECT_FALSE(edid);
    EXPECT_EQ(edid.error().code(), ErrorCode::kBadData);
    return edid.error().message();
  };
  EXPECT_THAT(message_of({}), HasSubstr("0 bytes"));
  std::vector<std::uint8_t> bytes = fake_edid("x", 8);
  bytes.resize(127);
  EXPECT_THAT(message_of(bytes), HasSubstr("127 bytes"));
  bytes = fake_edid("x", 8);
  bytes[3] = 7;
  EXPECT_THAT(message_of(bytes), HasSubstr("byte 3 is 0x07"));
  bytes = fake_edid("x", 8);
  bytes[60] ^= 1;
  EXPECT_THAT(message_of(bytes), HasSubstr("checksum"));
}

}  // namespace
}  // namespace cyclorama::output
