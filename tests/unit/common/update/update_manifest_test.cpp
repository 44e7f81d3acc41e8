// SPDX-License-Identifier: Apache-2.0
#include "common/update/update_manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using testing::HasSubstr;

const std::string kHash(64, 'a');
constexpr const char* kImage = "cyclorama-museum";

std::string line(const std::string& name) { return kHash + "  " + name + "\n"; }
std::string good() {
  return line("cyclorama-museum_0.2.efi") + line("cyclorama-museum_0.2_0b-1.root.raw") +
         line("cyclorama-museum_0.2_0c-2.verity.raw");
}

TEST(UpdateManifest, has_a_kernel_a_root_image_and_its_hashes_in_any_order) {
  const std::string other = line("cyclorama-museum_0.2_0c-2.verity.raw") + line("cyclorama-museum_0.2.efi") + kHash +
                            " *cyclorama-museum_0.2_0b-1.root.raw";
  for (const std::string& text : {good(), other}) {
    const auto manifest = parse_update_manifest(text, kImage);
    ASSERT_TRUE(manifest) << manifest.error().message();
    EXPECT_EQ(manifest->version, "0.2");
    EXPECT_EQ(manifest->files[0].name, "cyclorama-museum_0.2.efi");
    EXPECT_EQ(manifest->files[1].name, "cyclorama-museum_0.2_0b-1.root.raw");
    EXPECT_EQ(manifest->files[2].name, "cyclorama-museum_0.2_0c-2.verity.raw");
    EXPECT_EQ(manifest->files[2].sha256, kHash);
  }
}

TEST(UpdateManifest, refuses_everything_else_by_line) {
  const std::vector<std::pair<std::string, const char*>> wrong{
      {"", "line 0: it ends without a file '.efi'"},
      {line("cyclorama-museum_0.2.efi"), "line 1: it ends without a file '.root.raw'"},
      {good() + line("cyclorama-museum_0.2.efi"), "line 4: a second file"},
      {good() + "\n", "line 4: not a SHA-256"},
      {"x" + good(), "line 1: not a SHA-256"},
      {line("cyclorama-museum_0.2.efi") + line("cyclorama-museum_0.3_0b.root.raw"), "line 2: another version"},
      {line("cyclorama-farm-host_0.2.efi"), "is no part of cyclorama-museum"},
      {line("cyclorama-museum-debug_0.2.efi"), "is no part of cyclorama-museum"},
      {line("cyclorama-museum_0.2_0b.efi"), "is no part"},
      {line("cyclorama-museum_0.2.root.raw"), "is no part"},
      {line("cyclorama-museum_0.2_../../x.root.raw"), "is no part"},
      {line("cyclorama-museum_../0.2.efi"), "is no part"},
      {line("cyclorama-museum_.efi"), "is no part"},
      {line("cyclorama-museum.efi"), "is no part"},
      {std::string(kMaxUpdateTextBytes + 1, '\n'), "too long"}};
  for (const auto& [text, says] : wrong) {
    const auto manifest = parse_update_manifest(text, kImage);
    ASSERT_FALSE(manifest) << text;
    EXPECT_EQ(manifest.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(manifest.error().message(), HasSubstr(says));
  }
}

TEST(UpdateManifest, compares_versions) {
  const std::vector<std::string> grow{
      "0.1", "0.1.0", "0.1.0.202611230121",          "0.1.0.202611230346", "0.1.1", "0.2.0.1", "0.10",
      "1",   "1.0",   "2.00000000000000000000000001"};
  for (std::size_t i = 0; i < grow.size(); ++i) {
    ASSERT_TRUE(is_image_version(grow[i])) << grow[i];
    for (std::size_t j = 0; j < grow.size(); ++j) {
      EXPECT_EQ(is_newer(grow[i], grow[j]), i > j) << grow[i] << " and " << grow[j];
    }
  }
  EXPECT_FALSE(is_newer("01.2", "1.02"));
  EXPECT_FALSE(is_newer("1.02", "01.2"));
  for (const char* const no : {"", ".", "1.", ".1", "1..2", "1.a", "1+3", "1/2", "-1"})
    EXPECT_FALSE(is_image_version(no)) << no;
}

}  // namespace
}  // namespace cyclorama
