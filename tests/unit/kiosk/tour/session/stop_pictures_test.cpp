// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/stop_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"
#include "common/wire/convert.h"
#include "tests/doubles/fake_farm.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr std::uint64_t kPlenty = std::uint64_t{64} << 20;

class StopPicturesTest : public testing::Test {
 protected:
  StopPicturesTest() {
    fs::remove_all(folder);
    visit.scene = fake_scene("plain");
    to_wire(PictureShape(Panorama{64, 32, 2.0, 0.5, -0.5}), &visit.wanted);
  }
  ~StopPicturesTest() override { fs::remove_all(folder); }
  StopPictures::Wanted wanted(const std::string& name, double x) const {
    StopPictures::Wanted wanted{name, {}, 7};
    wanted.view.mutable_eye_m()->set_x(x);
    wanted.view.mutable_eye_m()->set_y(1.6);
    *wanted.view.mutable_panorama() = visit.wanted;
    wanted.view.set_samples(1);
    wanted.view.set_jpeg_quality(90);
    return wanted;
  }
  std::unique_ptr<StopPictures> open(const FakeFarm& farm, std::uint64_t max_bytes = kPlenty) {
    client::FarmClientOptions options;
    options.coordinators = {farm.address()};
    auto pictures = StopPictures::open(folder, max_bytes, options);
    CHECK(pictures);
    return *std::move(pictures);
  }
  static bool eventually(const std::function<bool()>& condition) {
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    const TimePoint end = SteadyClock().now() + 20s;
    while (!condition()) {
      if (SteadyClock().now() > end) return false;
      never.wait_for(lock, 5ms);
    }
    return true;
  }

  const fs::path folder = fs::temp_directory_path() / (std::string("stop_pictures_") +
                                                       testing::UnitTest::GetInstance()->current_test_info()->name());
  KeptVisit visit;
};

TEST_F(StopPicturesTest, are_fetched_while_they_may_and_kept_over_a_restart) {
  FakeFarm farm;
  {
    const auto pictures = open(farm);
    pictures->set_wanted(visit, {wanted("a", 0), wanted("b", 1)});
    EXPECT_FALSE(farm.wait_for_views(1, 200ms)) << "nobody has allowed it";
    pictures->allow(true);
    ASSERT_TRUE(eventually([&] { return pictures->progress().kept == 2; }));
    EXPECT_EQ(farm.sessions(), 2) << "each in a session of its own";
  }
  const auto pictures = open(farm);
  pictures->set_wanted(visit, {wanted("a", 0), wanted("b", 1)});
  EXPECT_TRUE(pictures->is_kept("b"));
  const auto picture = pictures->read("b");
  ASSERT_TRUE(picture) << picture.error().message();
  EXPECT_EQ(picture->view.eye_m().x(), 1.0);
  EXPECT_EQ(picture->tiles.size(), 1u);
  const auto earlier = pictures->earlier_visit();
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->scene.title(), visit.scene.title());
}

TEST_F(StopPicturesTest, are_removed_when_they_are_not_wanted_any_more) {
  FakeFarm farm;
  const auto pictures = open(farm);
  pictures->allow(true);
  pictures->set_wanted(visit, {wanted("a", 0), wanted("b", 1)});
  ASSERT_TRUE(eventually([&] { return pictures->progress().kept == 2; }));
  pictures->set_wanted(visit, {wanted("a", 0)});
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "one picture, and the visit";
  pictures->set_wanted(visit, {wanted("a", 0.5)});
  EXPECT_FALSE(pictures->is_kept("a") && pictures->read("a")->view.eye_m().x() == 0.0) << "the stop has moved";
}

TEST_F(StopPicturesTest, keep_to_the_budget_and_tell_what_does_not_fit) {
  FakeFarm farm;
  const auto pictures = open(farm, 1);
  pictures->allow(true);
  pictures->set_wanted(visit, {wanted("a", 0), wanted("b", 1)});
  ASSERT_TRUE(eventually([&] { return pictures->progress().trouble.find("2 of 2") != std::string::npos; }))
      << pictures->progress().trouble;
  EXPECT_EQ(pictures->progress().bytes, 0u);
}

TEST_F(StopPicturesTest, that_are_damaged_are_fetched_again) {
  FakeFarm farm;
  const auto pictures = open(farm);
  pictures->allow(true);
  pictures->set_wanted(visit, {wanted("a", 0)});
  ASSERT_TRUE(eventually([&] { return pictures->is_kept("a"); }));
  pictures->allow(false);
  const fs::path file = folder / (wanted("a", 0).key() + ".picture");
  auto bytes = read_text_file(file, kPlenty);
  ASSERT_TRUE(bytes);
  (*bytes)[bytes->size() / 2] ^= 1;
  ASSERT_TRUE(write_file_atomically(file, std::string_view(*bytes)));
  EXPECT_THAT(pictures->read("a").error().message(), HasSubstr("damaged"));
  EXPECT_FALSE(pictures->is_kept("a"));
  pictures->allow(true);
  EXPECT_TRUE(eventually([&] { return pictures->is_kept("a"); }));
}

TEST_F(StopPicturesTest, tell_why_nothing_comes_from_a_farm_that_is_away) {
  auto farm = std::make_unique<FakeFarm>();
  const auto pictures = open(*farm);
  farm.reset();
  pictures->set_wanted(visit, {wanted("a", 0)});
  pictures->allow(true);
  EXPECT_TRUE(eventually([&] { return !pictures->progress().trouble.empty(); }));
}

TEST(KeptPicture, is_read_as_it_was_written_and_refused_when_it_is_no_frame) {
  KeptPicture picture;
  to_wire(PictureShape(Panorama{64, 32, 2.0, 0.5, -0.5}), picture.view.mutable_panorama());
  picture.view.mutable_eye_m();
  picture.view.set_number(1);
  picture.view.set_samples(1);
  picture.view.set_jpeg_quality(90);
  wire::Tile tile;
  tile.set_view_number(1);
  tile.set_width_px(64);
  tile.set_height_px(32);
  tile.set_jpeg("jpeg");
  picture.tiles.push_back(tile);
  picture.end.set_complete(true);
  picture.end.set_tiles(1);
  const std::string bytes = to_bytes(picture);
  const auto read = parse_kept_picture(bytes);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(to_bytes(*read), bytes);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(parse_kept_picture(std::string_view(bytes).substr(0, length)));
  picture.end.set_tiles(2);
  EXPECT_FALSE(parse_kept_picture(to_bytes(picture)));
  picture.tiles.front().set_x_px(48);
  EXPECT_FALSE(parse_kept_picture(to_bytes(picture)));
  EXPECT_FALSE(parse_kept_visit(bytes));
}

}  // namespace
}  // namespace cyclorama::tour
