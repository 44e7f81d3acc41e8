// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/calibration_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "common/base/file.h"
#include "tests/support/small_calibration.h"

namespace cyclorama::calibration {
namespace {

class CalibrationFile : public testing::Test {
 protected:
  CalibrationFile() {
    std::string name = (std::filesystem::temp_directory_path() / "calibration-XXXXXX").string();
    CHECK(mkdtemp(name.data()) != nullptr);
    folder_ = name;
  }
  ~CalibrationFile() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(CalibrationFile, survives_a_round_trip) {
  const Calibration written = small_calibration("2026-01-01T00-00-00Z");
  const auto saved = save_calibration(folder_, written);
  ASSERT_TRUE(saved) << saved.error().message();
  const auto read = read_calibration(folder_);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(calibration_json(*read), calibration_json(written));
  ASSERT_EQ(read->projectors.size(), 2U);
  const MeasuredMap& map = read->projectors[0].map;
  EXPECT_LE((map.directions[1] - written.projectors[0].map.directions[1]).norm(), 1e-6);
  EXPECT_FALSE(map.directions[3].allFinite());
  EXPECT_TRUE(std::isinf(map.sigma_px[3]));
}

TEST_F(CalibrationFile, keeps_the_previous_calibration_which_can_be_restored) {
  ASSERT_TRUE(save_calibration(folder_, small_calibration("2026-01-01T00-00-00Z")));
  ASSERT_TRUE(save_calibration(folder_, small_calibration("2026-01-02T00-00-00Z")));
  EXPECT_EQ(kept_calibrations(folder_), (std::vector<std::string>{"2026-01-02T00-00-00Z", "2026-01-01T00-00-00Z"}));
  EXPECT_EQ(read_calibration(folder_)->date, "2026-01-02T00-00-00Z");
  ASSERT_TRUE(restore_calibration(folder_, "2026-01-01T00-00-00Z"));
  EXPECT_EQ(read_calibration(folder_)->date, "2026-01-01T00-00-00Z");
  EXPECT_FALSE(restore_calibration(folder_, "2025-01-01T00-00-00Z"));
  EXPECT_FALSE(restore_calibration(folder_, "../../etc"));
  EXPECT_FALSE(save_calibration(folder_, small_calibration("2026-01-02T00-00-00Z")));
  EXPECT_FALSE(save_calibration(folder_, small_calibration("../x")));
}

TEST_F(CalibrationFile, keeps_the_ten_newest) {
  for (int day = 10; day < 24; ++day) {
    ASSERT_TRUE(save_calibration(folder_, small_calibration("2026-01-" + std::to_string(day) + "T00-00-00Z")));
  }
  EXPECT_EQ(kept_calibrations(folder_).size(), 10U);
  EXPECT_EQ(kept_calibrations(folder_).back(), "2026-01-14T00-00-00Z");
}

// Simulates a power cut between two files: a calibration counts only once its last file is written.
TEST_F(CalibrationFile, takes_effect_only_when_all_its_files_are_written) {
  const CalibrationPart light{"light.json", "{}"};
  ASSERT_TRUE(save_calibration(folder_, small_calibration("2026-01-01T00-00-00Z"), {}, {&light, 1}));
  const auto own = folder_ / "calibrations/2026-01-01T00-00-00Z";
  EXPECT_EQ(*read_text_file(own / "light.json", 100), "{}");
  const auto written = [&](const char* name) { return std::filesystem::last_write_time(own / name); };
  EXPECT_LE(written("2.sigma.pfm"), written("light.json"));
  EXPECT_LE(written("light.json"), written("calibration.json"));

  // The last step fails because a folder has the file's name.
  std::filesystem::rename(folder_ / "calibration.json", folder_ / "before.json");
  std::filesystem::create_directories(folder_ / "calibration.json/in the way");
  ASSERT_FALSE(save_calibration(folder_, small_calibration("2026-01-02T00-00-00Z"), {}, {&light, 1}));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "calibrations/2026-01-02T00-00-00Z/light.json"));

  // A part fails: nothing of that date counts, and the previous calibration still does.
  std::filesystem::remove_all(folder_ / "calibration.json");
  std::filesystem::rename(folder_ / "before.json", folder_ / "calibration.json");
  const CalibrationPart too_long{std::string(300, 'x'), ""};
  ASSERT_FALSE(save_calibration(folder_, small_calibration("2026-01-03T00-00-00Z"), {}, {&too_long, 1}));
  EXPECT_EQ(read_calibration(folder_)->date, "2026-01-01T00-00-00Z");
  EXPECT_EQ(kept_calibrations(folder_).size(), 2U);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "calibrations/2026-01-03T00-00-00Z"));
  ASSERT_TRUE(save_calibration(folder_, small_calibration("2026-01-04T00-00-00Z"), {}, {&light, 1}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "calibrations/2026-01-03T00-00-00Z")) << "the unfinished one is left";
  for (const char* name : {"", ".", "..", "../light.json", "/tmp/light.json"}) {
    const CalibrationPart elsewhere{name, ""};
    EXPECT_FALSE(save_calibration(folder_, small_calibration("2026-01-05T00-00-00Z"), {}, {&elsewhere, 1})) << name;
  }
}

TEST_F(CalibrationFile, names_the_broken_map) {
  ASSERT_TRUE(save_calibration(folder_, small_calibration("2026-01-01T00-00-00Z")));
  const auto map = folder_ / "calibrations/2026-01-01T00-00-00Z/2.map.pfm";
  ASSERT_TRUE(write_file_atomically(map, std::string_view("PF\n1 1\n-1.0\n            ")));
  const auto read = read_calibration(folder_);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message().find("2.map.pfm"), std::string::npos) << read.error().message();
}

TEST(CalibrationJson, names_the_position_of_a_mistake) {
  const std::string good = calibration_json(small_calibration("2026-01-01T00-00-00Z"));
  struct Case {
    std::string from, to, position;
  };
  const Case cases[] = {{"\"cells_x\": 2", "\"cells_x\": 0", "/projectors/0/cells_x"},
                        {"\"pitch_rad\": 0.0", "\"pitch_rad\": \"low\"", "/turntable/pitch_rad"},
                        {"\"surface\": \"cylinder\"", "\"surface\": \"cube\"", "/wall/surface"},
                        {"\"date\": \"2026", "\"date\": \"../..", "/date"},
                        {"calibrations/2026-01-01T00-00-00Z/1.map.pfm", "/etc/passwd", "/projectors/0/map"},
                        {"\"version\": 2", "\"version\": 1", "/version"},
                        {"\"is_previous\": false", "\"is_previous\": false, \"more\": 1", "/projectors/0"},
                        {"\"right\"", "\"left\"", "/projectors/1/name"}};
  ASSERT_TRUE(parse_calibration(good, "c.json"));
  for (const Case& c : cases) {
    std::string bad = good;
    const auto at = bad.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from;
    bad.replace(at, c.from.size(), c.to);
    const auto parsed = parse_calibration(bad, "c.json");
    ASSERT_FALSE(parsed) << c.to;
    EXPECT_EQ(parsed.error().code(), ErrorCode::kBadData);
    EXPECT_NE(parsed.error().message().find("c.json: " + c.position), std::string::npos) << parsed.error().message();
    EXPECT_NE(parsed.error().message().find("; "), std::string::npos) << parsed.error().message();
  }
}

TEST(CalibrationJson, refuses_every_truncation) {
  const std::string good = calibration_json(small_calibration("2026-01-01T00-00-00Z"));
  for (std::size_t length = 0; length + 2 < good.size(); length += 37) {
    const auto parsed = parse_calibration(std::string_view(good).substr(0, length), "c.json");
    ASSERT_FALSE(parsed);
    EXPECT_NE(parsed.error().message().find("byte"), std::string::npos);
  }
}

}  // namespace
}  // namespace cyclorama::calibration
