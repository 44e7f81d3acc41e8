// SPDX-License-Identifier: Apache-2.0
#include "common/edid/edid.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <numeric>

#include "common/base/file.h"
#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama {
namespace {

using ::testing::ElementsAre;
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

/// Adds a detailed timing of 1920x1080 at 60 Hz in the third descriptor.
std::vector<std::uint8_t> with_full_hd(std::vector<std::uint8_t> bytes) {
  const std::array<std::uint8_t, 18> timing{0x02, 0x3a, 0x80, 0x18, 0x71, 0x38, 0x2d, 0x40, 0x58,
                                            0x2c, 0x45, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1e};
  std::copy(timing.begin(), timing.end(), bytes.begin() + 90);
  return with_checksum(std::move(bytes));
}

std::vector<std::string> timings_of(const std::vector<std::uint8_t>& bytes) {
  const auto edid = parse_edid(bytes);
  EXPECT_TRUE(edid);
  std::vector<std::string> texts;
  for (const VideoTiming& t : edid->timings) {
    texts.push_back(std::to_string(t.horizontal.visible) + "x" + std::to_string(t.vertical.visible) +
                    (t.is_interlaced ? "i" : "") + "@" + std::to_string(std::lround(t.refresh_hz())) +
                    (t.is_preferred ? "!" : ""));
  }
  return texts;
}

/// Adds an extension block with these bytes behind its tag.
std::vector<std::uint8_t> with_extension(std::vector<std::uint8_t> bytes, std::uint8_t tag,
                                         const std::vector<std::uint8_t>& data) {
  bytes[126] = static_cast<std::uint8_t>(bytes[126] + 1);
  bytes = with_checksum(std::move(bytes));
  std::vector<std::uint8_t> block(128, 0);
  block[0] = tag;
  std::copy(data.begin(), data.end(), block.begin() + 1);
  block[127] = static_cast<std::uint8_t>(256 - std::accumulate(block.begin(), block.end(), 0) % 256);
  bytes.insert(bytes.end(), block.begin(), block.end());
  return bytes;
}

TEST(Edid, reads_the_serial_from_its_descriptor_or_its_number) {
  EXPECT_EQ(parse_edid(fake_edid("x", 8, "X4K1"))->serial, "X4K1");
  std::vector<std::uint8_t> bytes = fake_edid("x", 8);
  EXPECT_EQ(parse_edid(bytes)->serial, "");
  bytes[12] = 0x39;
  bytes[13] = 0x30;
  EXPECT_EQ(parse_edid(with_checksum(bytes))->serial, "12345");
  for (std::size_t i = 12; i < 16; ++i) bytes[i] = 1;
  EXPECT_EQ(parse_edid(with_checksum(bytes))->serial, "");
}

TEST(Edid, lists_detailed_standard_and_established_timings) {
  std::vector<std::uint8_t> bytes = with_full_hd(fake_edid("x", 8));
  EXPECT_THAT(timings_of(bytes), ElementsAre("1920x1080@60"));
  std::copy(bytes.begin() + 90, bytes.begin() + 108, bytes.begin() + 54);
  std::fill(bytes.begin() + 90, bytes.begin() + 108, 0);
  bytes[35] = 0x21;           // 640x480 and 800x600 at 60 Hz.
  bytes[38] = 0x81;           // 1280 wide,
  bytes[39] = 0x80;           // 5:4, 60 Hz.
  bytes[40] = 0x8b;           // 1360 wide,
  bytes[41] = 0xc0;           // 16:9, 60 Hz: 1366x768.
  bytes[42] = bytes[43] = 0;  // Not allowed, but some devices have it.
  EXPECT_THAT(timings_of(with_checksum(bytes)),
              ElementsAre("1920x1080@60!", "1280x1024@60", "1366x768@60", "640x480@60", "800x600@60"));
  bytes[19] = 0;  // Version 1.0 has no preferred timing, and its square ratio was 1:1.
  bytes[38] = 0x61;
  bytes[39] = 0x00;
  EXPECT_THAT(timings_of(with_checksum(bytes)),
              ElementsAre("1920x1080@60", "1024x1024@60", "1366x768@60", "640x480@60", "800x600@60"));
}

TEST(Edid, lists_the_timings_of_extension_blocks_that_are_whole) {
  const std::vector<std::uint8_t> base = with_full_hd(fake_edid("x", 8));
  // Data blocks: two codes of formats, one of them native, and HDMI's list of 3840x2160.
  const std::vector<std::uint8_t> cta{3,    17,   0,    0x42, 0x84, 34,   0x69, 0x03, 0x0c,
                                      0x00, 0x10, 0x00, 0x00, 0x00, 0x20, 0x00, 0x20};
  EXPECT_THAT(timings_of(with_extension(base, 0x02, cta)), ElementsAre("1920x1080@60", "1280x720@60", "1920x1080@30"));
  std::vector<std::uint8_t> broken = with_extension(base, 0x02, cta);
  broken[200] ^= 1;
  EXPECT_THAT(timings_of(broken), ElementsAre("1920x1080@60"));
  broken.resize(200);
  EXPECT_THAT(timings_of(broken), ElementsAre("1920x1080@60"));
  // A detailed timing of DisplayID, which is preferred.
  const std::vector<std::uint8_t> display_id{0x12, 121,  0x03, 0x00, 0x03, 0x01, 0x14, 0x64, 0x19,
                                             0x00, 0x88, 0x3f, 0x06, 0x9f, 0x00, 0x2f, 0x00, 0x1f,
                                             0x00, 0xaf, 0x04, 0x22, 0x00, 0x02, 0x00, 0x05, 0x00};
  EXPECT_THAT(timings_of(with_extension(base, 0x70, display_id)), ElementsAre("1600x1200@30!", "1920x1080@60"));
}

TEST(Edid, leaves_out_impossible_timings) {
  std::vector<std::uint8_t> bytes = with_full_hd(fake_edid("x", 8));
  bytes[90 + 9] = 0;  // Without a horizontal sync pulse.
  EXPECT_THAT(timings_of(with_checksum(bytes)), ElementsAre());
  bytes = with_full_hd(fake_edid("x", 8));
  bytes[90] = 1;  // 10 kHz: a picture in four minutes.
  bytes[91] = 0;
  EXPECT_THAT(timings_of(with_checksum(bytes)), ElementsAre());
}

TEST(Edid, refuses_a_file_that_nothing_can_be_driven_by) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("{}.edid", ::getpid());
  const auto write = [&](const std::vector<std::uint8_t>& bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_TRUE(write_file_atomically(file, text));
    return read_edid_to_drive(file);
  };
  EXPECT_TRUE(write(with_full_hd(fake_edid("x", 8))));
  EXPECT_THAT(write(fake_edid("x", 8)).error().message(), HasSubstr(".edid: this EDID lists no timing"));
  EXPECT_THAT(write({1, 2}).error().message(), HasSubstr("2 bytes"));
  std::filesystem::remove(file);
  EXPECT_EQ(read_edid_to_drive(file).error().code(), ErrorCode::kNotFound);
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
}  // namespace cyclorama
