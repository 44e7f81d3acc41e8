// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/scan_view.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "common/base/file.h"

namespace cyclorama::scan {
namespace {

using ::testing::HasSubstr;

class ScanFolderTest : public ::testing::Test {
 protected:
  ScanFolderTest() : folder_(std::filesystem::path(::testing::TempDir()) / ("scan-" + std::to_string(getpid()))) {}
  ~ScanFolderTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  /// Expects that resuming fails with a remedy.
  void expect_refused(const ScanIdentity& identity, const std::string& why) {
    const auto resumed = ScanFolder::resume(folder_, identity);
    ASSERT_FALSE(resumed.has_value());
    EXPECT_EQ(resumed.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(resumed.error().message(), HasSubstr(why));
    EXPECT_THAT(resumed.error().message(), HasSubstr("; calibrate again"));
  }
  std::filesystem::path folder_;
};

ScanIdentity identity() {
  return {"usb-1", 640, 480, {{"left", 320, 200}, {"right", 320, 200}}, {-0.5, 0.0, 0.5}, "finest bit 0"};
}

ScanView view(std::size_t direction, std::size_t projector, std::size_t correspondences) {
  ScanView v{direction, projector, -0.25, 1.0 / 30.0, 0.01, 38, {}};
  for (std::size_t i = 0; i < correspondences; ++i) {
    const auto at = static_cast<float>(i % 300);
    v.correspondences.push_back({at + 0.5f, 7.5f, at + 0.25f, 19.125f, 0.11f, static_cast<std::uint32_t>(projector)});
  }
  return v;
}

bool same(const std::vector<solve::Correspondence>& a, const std::vector<solve::Correspondence>& b) {
  return a.size() == b.size() && encode_correspondences(a) == encode_correspondences(b);
}

TEST_F(ScanFolderTest, resumes_with_the_stored_views) {
  {
    auto scan = ScanFolder::begin(folder_, identity());
    ASSERT_TRUE(scan.has_value()) << scan.error().message();
    ASSERT_TRUE(scan->keep(view(0, 0, 500)).has_value());
    ASSERT_TRUE(scan->keep(view(1, 1, 3)).has_value());
    ASSERT_TRUE(scan->keep(view(1, 1, 40)).has_value()) << "the newer one counts";
  }
  const auto scan = ScanFolder::resume(folder_, identity());
  ASSERT_TRUE(scan.has_value()) << scan.error().message();
  EXPECT_EQ(scan->views().size(), 2u);
  ASSERT_NE(scan->find(0, 0), nullptr);
  EXPECT_TRUE(same(scan->find(0, 0)->correspondences, view(0, 0, 500).correspondences));
  EXPECT_DOUBLE_EQ(scan->find(0, 0)->angle_rad, -0.25);
  EXPECT_EQ(scan->find(0, 0)->pictures, 38);
  ASSERT_NE(scan->find(1, 1), nullptr);
  EXPECT_EQ(scan->find(1, 1)->correspondences.size(), 40u);
  EXPECT_EQ(scan->find(1, 1)->correspondences[0].projector, 1u);
  EXPECT_EQ(scan->find(2, 0), nullptr);
}

TEST_F(ScanFolderTest, does_not_resume_a_finished_or_abandoned_scan) {
  ASSERT_TRUE(ScanFolder::begin(folder_, identity()));
  std::filesystem::last_write_time(folder_ / "manifest.json",
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(11));
  EXPECT_TRUE(ScanFolder::resume(folder_, identity()));
  std::filesystem::last_write_time(folder_ / "manifest.json",
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(13));
  const auto stale = ScanFolder::resume(folder_, identity());
  ASSERT_FALSE(stale);
  EXPECT_EQ(stale.error().code(), ErrorCode::kBadData);
  EXPECT_THAT(stale.error().message(), HasSubstr("more than 12 hours"));
  ASSERT_TRUE(ScanFolder::begin(folder_, identity()));
  ScanFolder::end(folder_);
  const auto ended = ScanFolder::resume(folder_, identity());
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code(), ErrorCode::kNotFound);
}

TEST_F(ScanFolderTest, starts_anew_in_the_folder_of_an_older_scan) {
  ASSERT_TRUE(ScanFolder::begin(folder_, identity())->keep(view(0, 0, 10)).has_value());
  ASSERT_TRUE(ScanFolder::begin(folder_, identity()).has_value());
  const auto scan = ScanFolder::resume(folder_, identity());
  ASSERT_TRUE(scan.has_value());
  EXPECT_TRUE(scan->views().empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "0-0.view"));
}

TEST_F(ScanFolderTest, has_nothing_to_resume_in_an_empty_folder) {
  const auto resumed = ScanFolder::resume(folder_, identity());
  ASSERT_FALSE(resumed.has_value());
  EXPECT_EQ(resumed.error().code(), ErrorCode::kNotFound);
}

TEST_F(ScanFolderTest, refuses_the_views_of_another_scan_and_names_the_difference) {
  ASSERT_TRUE(ScanFolder::begin(folder_, identity())->keep(view(0, 0, 10)).has_value());
  ScanIdentity other = identity();
  other.camera = "usb-2";
  expect_refused(other, "camera 'usb-1'");
  other = identity();
  other.camera_width_px = 1280;
  expect_refused(other, "640x480");
  other = identity();
  other.projectors[1].name = "middle";
  expect_refused(other, "projectors");
  other = identity();
  other.angles_rad[2] = 0.6;
  expect_refused(other, "directions");
  other = identity();
  other.patterns = "finest bit 1";
  expect_refused(other, "patterns");
}

TEST_F(ScanFolderTest, refuses_a_view_with_any_damaged_byte) {
  ASSERT_TRUE(ScanFolder::begin(folder_, identity())->keep(view(0, 0, 6)).has_value());
  const std::filesystem::path file = folder_ / "0-0.view";
  const auto whole = read_file(file, 1 << 20);
  ASSERT_TRUE(whole.has_value());
  for (std::size_t i = 0; i < whole->size(); i += 7) {
    std::vector<std::byte> bytes = *whole;
    bytes[i] ^= std::byte{0x10};
    ASSERT_TRUE(write_file_atomically(file, bytes).has_value());
    expect_refused(identity(), "0-0.view");
  }
  ASSERT_TRUE(write_file_atomically(file, std::span(*whole).first(whole->size() - 3)).has_value());
  expect_refused(identity(), "0-0.view");
  std::filesystem::remove(file);
  expect_refused(identity(), "damaged");
}

TEST_F(ScanFolderTest, refuses_a_truncated_manifest) {
  ASSERT_TRUE(ScanFolder::begin(folder_, identity())->keep(view(0, 0, 6)).has_value());
  const auto text = read_text_file(folder_ / "manifest.json", 1 << 20);
  ASSERT_TRUE(text.has_value());
  for (std::size_t length = 0; length + 2 < text->size(); length += 11) {
    EXPECT_FALSE(parse_manifest(std::string_view(*text).substr(0, length), "manifest.json").has_value()) << length;
  }
}

TEST(ScanManifest, names_the_position_of_a_mistake) {
  ScanManifest manifest{identity(), {{view(2, 1, 0), 12, "0123456789abcdef"}}};
  std::string text = manifest_text(manifest);
  ASSERT_TRUE(parse_manifest(text, "m").has_value());
  EXPECT_EQ(manifest_text(*parse_manifest(text, "m")), text);
  const auto at = text.find("\"direction\": 2");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 14, "\"direction\": 3");
  const auto refused = parse_manifest(text, "m");
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message(), HasSubstr("m: /views/0/direction"));
}

TEST(ScanCorrespondences, are_refused_on_the_far_edge_of_the_cameras_picture) {
  const solve::Correspondence last{639.5f, 479.5f, 320.0f, 200.0f, 0.1f, 0};
  EXPECT_TRUE(decode_correspondences(encode_correspondences({&last, 1}), identity(), 0).has_value());
  for (const solve::Correspondence& position : {solve::Correspondence{640.0f, 1.0f, 1.0f, 1.0f, 0.1f, 0},
                                                solve::Correspondence{1.0f, 480.0f, 1.0f, 1.0f, 0.1f, 0}}) {
    EXPECT_FALSE(decode_correspondences(encode_correspondences({&position, 1}), identity(), 0).has_value());
  }
}

TEST(ScanCorrespondences, are_refused_outside_the_pictures) {
  for (const solve::Correspondence& position : {solve::Correspondence{-1.0f, 1.0f, 1.0f, 1.0f, 0.1f, 0},
                                                solve::Correspondence{1.0f, 481.0f, 1.0f, 1.0f, 0.1f, 0},
                                                solve::Correspondence{1.0f, 1.0f, 321.0f, 1.0f, 0.1f, 0},
                                                solve::Correspondence{1.0f, 1.0f, 1.0f, std::nanf(""), 0.1f, 0},
                                                solve::Correspondence{1.0f, 1.0f, 1.0f, 1.0f, 0.0f, 0}}) {
    EXPECT_FALSE(decode_correspondences(encode_correspondences({&position, 1}), identity(), 0).has_value());
  }
}

}  // namespace
}  // namespace cyclorama::scan
