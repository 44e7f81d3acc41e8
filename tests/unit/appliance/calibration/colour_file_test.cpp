// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/colour_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "common/base/file.h"

namespace cyclorama::calibration {
namespace {

using ::testing::HasSubstr;

std::vector<CalibratedColour> two_colours() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  std::vector<CalibratedColour> colours;
  for (const char* const name : {"left", "right-2.b"}) {
    CalibratedColour one{name, warp::MaskImage(40, 30), {}};
    for (float& value : one.mask.data()) value = share(random);
    colours.push_back(std::move(one));
  }
  warp::HeadColour& colour = colours[1].colour;
  colour.matrix = Eigen::Matrix3d::Identity() + 0.1 * Eigen::Matrix3d::Ones();
  colour.black = {0.001, 0.002, 0.003};
  colour.black_lift = colours[0].mask;
  colour.response = {warp::ResponseCurve::srgb(9), warp::ResponseCurve::power(2.2, 20),
                     warp::ResponseCurve::power(1.8, 300)};
  return colours;
}

class ColourFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/colours.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(ColourFile, survives_a_round_trip_within_16_bits) {
  const auto written = two_colours();
  ASSERT_TRUE(write_colours(folder_, written));
  const auto read = read_colours(folder_);
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*read)[i].name, written[i].name);
    ASSERT_EQ((*read)[i].mask.width(), 40);
    for (std::size_t p = 0; p < written[i].mask.data().size(); ++p)
      ASSERT_NEAR((*read)[i].mask.data()[p], written[i].mask.data()[p], 1.0 / 131000.0);
  }
  EXPECT_FALSE((*read)[0].colour.matrix || (*read)[0].colour.black_lift || (*read)[0].colour.response);
  const warp::HeadColour& colour = (*read)[1].colour;
  ASSERT_TRUE(colour.matrix && colour.black_lift && colour.response);
  EXPECT_EQ(*colour.matrix, *written[1].colour.matrix);
  EXPECT_EQ(colour.black, written[1].colour.black);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ((*colour.response)[c].codes, (*written[1].colour.response)[c].codes);
}

TEST_F(ColourFile, may_be_absent) {
  const auto none = read_colours(folder_);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
}

TEST_F(ColourFile, numbers_its_pictures_whatever_the_projectors_names) {
  std::vector<CalibratedColour> colours = two_colours();
  colours[0].name = "../left \"one\"";
  ASSERT_TRUE(write_colours(folder_, colours));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "1.mask.png"));
  const auto read = read_colours(folder_);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->front().name, colours[0].name);
}

TEST_F(ColourFile, refuses_a_duplicate_name) {
  std::vector<CalibratedColour> colours = two_colours();
  colours[0].name = colours[1].name;
  const auto written = write_colours(folder_, colours);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "colours.json"));
}

TEST_F(ColourFile, names_a_mistake) {
  const std::string good = colours_json(two_colours());
  ASSERT_TRUE(parse_colours(good, "colours.json"));
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    CHECK(at != std::string::npos);
    text.replace(at, from.size(), to);
    const auto parsed = parse_colours(text, "colours.json");
    return parsed ? std::string("accepted") : parsed.error().message();
  };
  EXPECT_THAT(refused("1.mask.png", "../mask.png"), HasSubstr("/projectors/0/mask"));
  EXPECT_THAT(refused("\"left\"", "\"right-2.b\""), HasSubstr("/projectors/"));
  EXPECT_THAT(refused("cyclorama-colours", "colours"), HasSubstr("/format"));
  EXPECT_THAT(refused("\"version\": 2", "\"version\": 1"), HasSubstr("/version"));
  EXPECT_THAT(refused("\"red\"", "\"rouge\""), HasSubstr("/projectors/1/response"));
  EXPECT_THAT(refused("{", ""), HasSubstr("colours.json"));
  ASSERT_TRUE(write_colours(folder_, two_colours()));
  ASSERT_TRUE(write_file_atomically(folder_ / "1.mask.png", std::string_view("no PNG")));
  const auto read = read_colours(folder_);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message(), HasSubstr("1.mask.png"));
}

}  // namespace
}  // namespace cyclorama::calibration
