// SPDX-License-Identifier: Apache-2.0
// A museum's fixed cameras, including those without a measured lens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "appliance/calibration/camera_file.h"
#include "appliance/healing/healing_loop.h"
#include "appliance/healing/show_rooms.h"
#include "common/base/file.h"

namespace cyclorama::healing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class MuseumRoomsTest : public ::testing::Test {
 protected:
  MuseumRoomsTest() {
    std::string name = (std::filesystem::temp_directory_path() / "museum-rooms-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    folder_ = name;
    for (const char* position : {"own", "stick"}) std::filesystem::create_directory(folder_ / position);
  }
  ~MuseumRoomsTest() override { std::filesystem::remove_all(folder_); }

  void write_lens(const std::string& file, double focal_px) const {
    const calibration::CameraFile camera{"a camera",
                                         "2026-01-01T00-00-00Z",
                                         calibration::MeasuredLens::from_focal(640, 480, focal_px),
                                         calibration::LensModel::kPinhole,
                                         12,
                                         0.1,
                                         0.1};
    CHECK(write_file_atomically(folder_ / file, std::string_view(calibration::camera_json(camera))));
  }
  [[nodiscard]] std::unique_ptr<ShowRooms> rooms() const {
    return museum_rooms({}, {{"left", "v4l2:"}, {"right", "v4l2:"}}, {folder_ / "own", folder_ / "stick"}, 0.03,
                        clock_);
  }

  std::filesystem::path folder_;
  SteadyClock clock_;
};

TEST_F(MuseumRoomsTest, uses_the_usb_sticks_lens_where_the_calibration_has_none) {
  write_lens("own/left.json", 500.0);
  write_lens("stick/left.json", 600.0);
  write_lens("stick/right.json", 700.0);
  const auto made = rooms();
  ASSERT_THAT(made->cameras(), SizeIs(2));
  EXPECT_EQ(made->cameras()[0].lens.focal_u_px, 500.0);
  EXPECT_EQ(made->cameras()[1].lens.focal_u_px, 700.0);
  EXPECT_THAT(made->troubles(), IsEmpty());
}

TEST_F(MuseumRoomsTest, works_without_cameras_that_have_no_valid_lens) {
  write_lens("own/right.json", 500.0);
  const auto missing = rooms();
  ASSERT_THAT(missing->cameras(), SizeIs(1));
  EXPECT_EQ(missing->cameras()[0].name, "right");
  EXPECT_THAT(missing->troubles(), ElementsAre(AllOf(HasSubstr("camera 'left'"), HasSubstr("its lens is not known"),
                                                     HasSubstr("cameras/left.json"))));
  CHECK(write_file_atomically(folder_ / "own/left.json", std::string_view("{}")));
  write_lens("stick/left.json", 600.0);
  const auto damaged = rooms();
  EXPECT_THAT(damaged->cameras(), SizeIs(1)) << "what is damaged is said, not passed over";
  EXPECT_THAT(damaged->troubles(), ElementsAre(AllOf(HasSubstr("camera 'left'"), HasSubstr("left.json"))));
}

TEST_F(MuseumRoomsTest, reports_what_is_missing_without_any_lens) {
  InspectionService inspection("calibrator");
  HealingLoop::Options options;
  std::mutex mutex;
  std::condition_variable said;
  std::string sentence;
  bool is_well = true;
  options.tell = [&](const std::string& text, bool well) {
    const std::lock_guard lock(mutex);
    if (!text.starts_with("does not watch the wall")) return;
    sentence = text;
    is_well = well;
    said.notify_all();
  };
  HealingLoop loop({}, folder_, rooms(), clock_, &inspection, options);
  {
    std::unique_lock lock(mutex);
    said.wait_for(lock, std::chrono::seconds(30), [&] { return !sentence.empty(); });
    EXPECT_THAT(sentence, AllOf(HasSubstr("cameras/left.json"), HasSubstr("cameras/right.json")));
    EXPECT_FALSE(is_well);
  }
  const auto realigned = loop.realign();
  ASSERT_FALSE(realigned);
  EXPECT_THAT(realigned.error().message(), HasSubstr("cameras/left.json"));
  const auto held = loop.hold();
  const auto placed = loop.place_cameras({});
  ASSERT_FALSE(placed);
  EXPECT_EQ(placed.error().code(), ErrorCode::kNotFound);
  EXPECT_THAT(placed.error().message(), HasSubstr("cameras/left.json"));
}

}  // namespace
}  // namespace cyclorama::healing
