// SPDX-License-Identifier: Apache-2.0
#include "common/image/ktx2.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "common/image/uastc.h"

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

std::vector<std::byte> bytes_of_hex(std::string_view hex) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

struct DecodedBlock {
  const char* block;
  const char* pixels;
};
/// A block of random bits in each of the 19 modes, and its pixels according to Binomial's transcoder (three.js 0.160).
constexpr std::array<DecodedBlock, 19> kBlockOfMode = {{
    {"01cd60a2866883662879ef0f7dc9cb30",
     "775153ff875e5eff4f3237ff614044ff210e18ff28131dff210e18ff966a68ff"
     "2f1922ff614044ff4f3237ff371f27ff40262dff371f27ff966a68ff805959ff"},
    {"75b13d110d2d13fc0a81713531eccc70",
     "8968e0ff8968e0ff7e78b3ff8968e0ff8968e0ff738984ff7e78b3ff8968e0ff"
     "689957ff7e78b3ff7e78b3ff7e78b3ff689957ff8968e0ff7e78b3ff8968e0ff"},
    {"bdb31c28f942241c95c10d570943c999",
     "44cc11ff44cc11ff997722ff1dd2b4ff50c013ff759b1aff68a818ff15a5c3ff"
     "5cb415ff5cb415ff44cc11ff1ac3b9ff44cc11ff818f1dff759b1aff18b3beff"},
    {"a38c851ac8490f0016bb18917f4cb926",
     "d1002eff2e2e00ffba17e8ffd13d3dffd17d4dff2e002eff5c74baffd1ba5cff"
     "d13d3dff2e2e00ff5c74baffd1002effd13d3dff2e1f0fff7b55c9ffd1ba5cff"},
    {"93910918454eeef22f8a155da0e21d9d",
     "91618aff2d842dff436a34ff318e41ff91618aff91618aff544727ff436a34ff"
     "706c6bff706c6bff544727ff20b14eff2d842dff4e784bff20b14eff544727ff"},
    {"8b330012373fd4df1c633c351ca0339d",
     "2bdbf7ff4f8de2ff2bdbf7ff665cd4ff20f3fdff7143cdff2bdbf7ff5a74dbff"
     "665cd4ff20f3fdff665cd4ff2bdbf7ff20f3fdff20f3fdff5a74dbff42a9e9ff"},
    {"5b9150609d67072687aa68a2def69340",
     "a68f43ff9e3119ffaf316fffaf316fff9e3119ffaf616fffaf8f6fffaf316fff"
     "af036fffa60343ffaf616fffb70399ffb78f99ffa63143ff9e8f19ff9e6119ff"},
    {"678df9f47185ee580ff82e9aa8d0395d",
     "249180ff4a8245ff6abd6aff91c591ff249180ff009eb8ff6abd6aff6abd6aff"
     "249180ff009eb8ff41b441ff41b441ff6e750dff91c591ff1aab1aff6abd6aff"},
    {"b796721fc3ce871d26ee53d92407f27c",
     "b594fb18b594fb18b594fb18b594fb18b594fb18b594fb18b594fb18b594fb18"
     "b594fb18b594fb18b594fb18b594fb18b594fb18b594fb18b594fb18b594fb18"},
    {"cffa3bfea29b52fad7154b77682cfb7a",
     "bbaa55bbde938e60de938e60cc9f718ebbaa55bbee88aa33de938e60bbaa55bb"
     "ee88aa33de938e60ee88aa33ee88aa3311dd99dd54ab72e9dd4422ffdd4422ff"},
    {"ba8dd54f9e89fc155ae2e424b3f7281a",
     "7b24793a7b24793a8325744b632087057e24773f632087057e24773f8325744b"
     "812575466b21821676237b2f6120880073227e278325744b6e22801c86257250"},
    {"54a1eabf7efbb65765a887bd9a1bc743",
     "91778fd8958980d68e9c9ed9959c80d6988971d48e9c9ed991ae8fd8989c71d4"
     "959c80d6919c8fd8989c71d491778fd8988971d48eae9ed9987771d48e899ed9"},
    {"a6f7867abbdd2fd4f6a12ab16e0a5429",
     "bf8d61c89bd58f5ea3c38478c77c56e2adb077949bd58f5eadb07794adb07794"
     "b69f6caebf8d61c8c77c56e2b69f6cae9bd58f5eb69f6caeb69f6caebf8d61c8"},
    {"df7f2e84f399e90576f8883453ca73f3",
     "cea6d823cea6d8236717e1d2cea6d823ce17e1d2ce17e1d267a6d82367a6d823"
     "cea6d8236717e1d26717e1d2cea6d8236717e1d2ce17e1d26717e1d2cea6d823"},
    {"0da5b7f378e03b8735cf9b5c6bbe8725",
     "62a68bc1338cc0c5338cc0c562a68bc162a68bc10773f3c98fbe58bc0773f3c9"
     "0773f3c962a68bc10773f3c90773f3c98fbe58bc8fbe58bc0773f3c9338cc0c5"},
    {"8544a8b00b590d8b437505eaad41ec06",
     "43434331313131345252522f5252522f5555552e343434342e2e2e353f3f3f32"
     "6464642c434343315d5d5d2d2e2e2e3534343434434343314646463138383833"},
    {"15a81582262e3287069b4f4cab0e7ffa",
     "898989cc8a8a8abe8a8a8abe8a8a8abecdcdcd528b8b8ba1898989cc898989cc"
     "e6e6e6d3e6e6e6d38b8b8ba18a8a8abedadada94dadada94e6e6e6d38b8b8ba1"},
    {"a5de02dda2774c17c7f339b2f6406fd8",
     "16161663868686ba1616169ebdbdbd80868686babdbdbd63bdbdbd8016161680"
     "868686804d4d4dba868686ba4d4d4d631616169e868686ba4d4d4dba16161663"},
    {"0972d84218a8b5849709e05dd4a183e8",
     "9e1a9effbe1591ffd81187ff7d1fabff362ac7ffc5148effde1084ff232ecfff"
     "1c2fd1ffd11289ff5026bdffcb138cff302cc9ffd81187ffd11289ff1c2fd1ff"},
}};

TEST(Uastc, every_mode_decodes_as_the_reference_transcoder_does) {
  for (const DecodedBlock& known : kBlockOfMode) {
    const auto pixels = decode_uastc(bytes_of_hex(known.block));
    ASSERT_TRUE(pixels.has_value()) << known.block;
    std::string hex;
    for (const auto& pixel : *pixels) {
      for (const std::uint8_t channel : pixel) hex += fmt::format("{:02x}", channel);
    }
    EXPECT_EQ(hex, known.pixels) << known.block;
  }
}

TEST(Uastc, a_mode_or_a_partition_that_does_not_exist_is_nothing) {
  EXPECT_FALSE(decode_uastc(bytes_of_hex("45000000000000000000000000000000")).has_value());
  // Mode 3 with the partition 15 of 11.
  EXPECT_FALSE(decode_uastc(bytes_of_hex("0300f000000000000000000000000000")).has_value());
}

/// Writes a KTX2 file with one level.
struct Ktx2Builder {
  std::uint32_t width = 8;
  std::uint32_t height = 4;
  std::uint32_t faces = 1;
  std::uint32_t scheme = 0;
  std::uint8_t model = 166;
  std::vector<std::byte> global;
  std::vector<std::byte> level;

  [[nodiscard]] std::vector<std::byte> file() const {
    std::vector<std::byte> bytes = bytes_of_hex("ab4b5458203230bb0d0a1a0a");
    const auto put = [&bytes](auto value) {
      const auto* const raw = reinterpret_cast<const std::byte*>(&value);
      bytes.insert(bytes.end(), raw, raw + sizeof value);
    };
    constexpr std::uint32_t kDescription = 104;
    constexpr std::uint32_t kDescriptionBytes = 44;
    const std::uint64_t global_at = kDescription + kDescriptionBytes;
    for (const std::uint32_t field : {0u, 1u, width, height, 0u, 0u, faces, 1u, scheme}) put(field);
    for (const std::uint32_t field : {kDescription, kDescriptionBytes, 0u, 0u}) put(field);
    for (const std::uint64_t field : {global_at, std::uint64_t{global.size()}}) put(field);
    for (const std::uint64_t field :
         {global_at + global.size(), std::uint64_t{level.size()}, std::uint64_t{level.size()}}) {
      put(field);
    }
    bytes.resize(global_at);
    bytes[kDescription + 12] = static_cast<std::byte>(model);
    bytes.insert(bytes.end(), global.begin(), global.end());
    bytes.insert(bytes.end(), level.begin(), level.end());
    return bytes;
  }
};

/// Writes bits, the lowest of each byte first.
class BitWriter {
 public:
  BitWriter& put(std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i, ++bits_) {
      if (bits_ % 8 == 0) bytes_.push_back(std::byte{0});
      bytes_.back() |= static_cast<std::byte>((value >> i & 1u) << bits_ % 8);
    }
    return *this;
  }
  /// A Huffman code whose only word, one bit, means `symbol`.
  BitWriter& put_code_of(std::uint32_t symbol) {
    put(symbol + 1, 14).put(19, 5);
    for (int i = 0; i < 19; ++i) put(i == 4 || i == 18 ? 1 : 0, 3);  // The lengths 0 and 1 have one bit each.
    return put(0, static_cast<int>(symbol)).put(1, 1);
  }
  [[nodiscard]] std::vector<std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
  std::size_t bits_ = 0;
};

/// Two blocks side by side: the left one has the second of two greys, the right one the first; both have all selectors.
Ktx2Builder etc1s_file() {
  // Colours change by 3, 2 or 1, by how light they are, and brightness by 1: grey 18 with 1, then 20 with 2.
  const auto endpoints =
      BitWriter().put_code_of(3).put_code_of(2).put_code_of(1).put_code_of(1).put(1, 1).put(0, 14).bytes();
  BitWriter raw_selector;
  raw_selector.put(4, 3);
  for (int row = 0; row < 4; ++row) raw_selector.put(0b11'10'01'00, 8);
  const std::vector<std::byte> selectors = raw_selector.bytes();
  // Both blocks step to the next endpoint and have the only selector; there is no history.
  const auto tables = BitWriter().put_code_of(15).put_code_of(1).put_code_of(0).put(0, 14).put(0, 13).bytes();
  BitWriter header;
  header.put(2, 16).put(1, 16);
  for (const auto* const part : {&endpoints, &selectors, &tables}) {
    header.put(static_cast<std::uint32_t>(part->size()), 32);
  }
  header.put(0, 32);
  for (const std::uint32_t field : {0u, 0u, 1u, 0u, 0u}) header.put(field, 32);
  Ktx2Builder built;
  built.scheme = 1;
  built.model = 163;
  built.global = header.bytes();
  for (const auto* const part : {&endpoints, &selectors, &tables}) {
    built.global.insert(built.global.end(), part->begin(), part->end());
  }
  built.level = {std::byte{0}};
  return built;
}

Ktx2Builder uastc_file() {
  Ktx2Builder built;
  for (const DecodedBlock& known : {kBlockOfMode[8], kBlockOfMode[0]}) {
    const std::vector<std::byte> block = bytes_of_hex(known.block);
    built.level.insert(built.level.end(), block.begin(), block.end());
  }
  return built;
}

TEST(Ktx2, etc1s_has_the_colours_of_its_codebooks) {
  const auto image = decode_image(etc1s_file().file(), 1000);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  const auto grey_at = [&](int x, int y) { return int{image->at(x, y)[0]}; };
  // The greys of 5 bits are 165 and 148 of 255.
  EXPECT_EQ(grey_at(0, 0), 165 - 29);
  EXPECT_EQ(grey_at(1, 1), 165 - 9);
  EXPECT_EQ(grey_at(2, 2), 165 + 9);
  EXPECT_EQ(grey_at(3, 3), 165 + 29);
  EXPECT_EQ(grey_at(4, 0), 148 - 17);
  EXPECT_EQ(grey_at(7, 3), 148 + 17);
  EXPECT_EQ(int{image->at(5, 2)[3]}, 255);
}

TEST(Ktx2, uastc_blocks_lie_side_by_side) {
  const auto image = decode_image(uastc_file().file(), 1000);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  EXPECT_EQ(int{image->at(3, 3)[0]}, 0xb5);
  EXPECT_EQ(int{image->at(4, 0)[0]}, 0x77);
}

TEST(Ktx2, a_size_that_no_blocks_fill_is_cut) {
  Ktx2Builder file = uastc_file();
  file.width = 5;
  file.height = 3;
  const auto image = decode_ktx2(file.file(), 1000);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  EXPECT_EQ(image->width(), 5);
  EXPECT_EQ(image->height(), 3);
}

TEST(Ktx2, every_truncation_is_refused) {
  for (const auto& whole : {etc1s_file().file(), uastc_file().file()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const auto image = decode_ktx2(std::span(whole).first(size), 1000);
      ASSERT_FALSE(image.has_value()) << size;
      EXPECT_EQ(image.error().code(), ErrorCode::kBadData);
    }
  }
}

TEST(Ktx2, damaged_bytes_are_a_picture_or_an_error) {
  for (const auto& whole : {etc1s_file().file(), uastc_file().file()}) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const int change : {1, 0x80, 0xff}) {
        std::vector<std::byte> damaged = whole;
        damaged[i] ^= static_cast<std::byte>(change);
        const auto image = decode_ktx2(damaged, 1000);
        EXPECT_TRUE(!image || !image->empty()) << i;
      }
    }
  }
}

TEST(Ktx2, too_many_pixels_are_refused_before_memory_is_taken) {
  Ktx2Builder file = uastc_file();
  file.width = 1u << 20;
  file.height = 1u << 20;
  const auto image = decode_ktx2(file.file(), 1000);
  ASSERT_FALSE(image.has_value());
  EXPECT_THAT(image.error().message(), HasSubstr("1048576x1048576 pixels; at most 1000"));
}

TEST(Ktx2, other_kinds_are_refused_by_name) {
  Ktx2Builder cube = uastc_file();
  cube.faces = 6;
  EXPECT_THAT(decode_ktx2(cube.file(), 1000).error().message(), HasSubstr("cube map"));
  Ktx2Builder other = uastc_file();
  other.model = 1;
  EXPECT_THAT(decode_ktx2(other.file(), 1000).error().message(), HasSubstr("colour model 1"));
  Ktx2Builder video = etc1s_file();
  video.global[20] = std::byte{2};
  EXPECT_THAT(decode_ktx2(video.file(), 1000).error().message(), HasSubstr("video"));
}

}  // namespace
}  // namespace cyclorama
