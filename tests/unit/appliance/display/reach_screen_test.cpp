// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reach_screen.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zbar.h>

#include <cstdlib>
#include <set>
#include <vector>

#include "appliance/display/reach_picture.h"
#include "common/base/file.h"
#include "common/image/image_file.h"
#include "common/image/png.h"
#include "common/language/catalogue.h"

namespace cyclorama::display {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr TimePoint kNow(100h);

PageReach example() {
  PageReach reach;
  reach.name = "Museum 洞窟 Höhle";
  reach.version = "0.1.0.202611250335";
  reach.language = "en";
  reach.addresses = {"https://192.0.2.117:8443/", "https://[2001:db8:4a:17:7d2:c0ff:fe31:99a4]:8443/",
                     "https://hall-3.local:8443/"};
  for (int i = 0; i < 32; ++i) reach.fingerprint += i == 0 ? "4F" : ":A1";
  reach.wall_code = "0123456789abcdef";
  reach.has_pin = true;
  reach.answered_at = kNow - 10s;
  return reach;
}

TextFont font() {
  auto font = TextFont::open_installed();
  CHECK(font);
  return *std::move(font);
}

/// Returns the content of the picture's QR code; empty if there is none.
std::string decoded(const RgbaImage& picture) {
  std::vector<unsigned char> grey;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) grey.push_back(picture.at(x, y)[1]);
  }
  zbar::ImageScanner scanner;
  scanner.set_config(zbar::ZBAR_NONE, zbar::ZBAR_CFG_ENABLE, 0);
  scanner.set_config(zbar::ZBAR_QRCODE, zbar::ZBAR_CFG_ENABLE, 1);
  zbar::Image image(static_cast<unsigned>(picture.width()), static_cast<unsigned>(picture.height()), "Y800",
                    grey.data(), grey.size());
  return scanner.scan(image) == 1 ? image.symbol_begin()->get_data() : "";
}

TEST(ShowsReach, until_there_is_a_pin_after_help_and_after_a_day_without_the_page) {
  PageReach reach = example();
  EXPECT_FALSE(shows_reach(reach, std::nullopt, kNow));
  EXPECT_TRUE(shows_reach(reach, kNow - 1min, kNow));
  EXPECT_FALSE(shows_reach(reach, kNow - 2min, kNow));
  reach.has_pin = false;
  EXPECT_TRUE(shows_reach(reach, std::nullopt, kNow));
  reach.has_pin = true;
  reach.answered_at = kNow - 24h + 1s;
  EXPECT_FALSE(shows_reach(reach, std::nullopt, kNow));
  reach.answered_at = kNow - 24h;
  EXPECT_TRUE(shows_reach(reach, std::nullopt, kNow));
  EXPECT_FALSE(shows_reach(std::nullopt, std::nullopt, TimePoint(23h))) << "the page may still start";
  EXPECT_TRUE(shows_reach(std::nullopt, std::nullopt, TimePoint(24h)));
}

TEST(ReachPicture, has_a_code_that_another_program_reads) {
  for (const auto& [width, height] : {std::pair(1920, 1080), std::pair(1024, 768), std::pair(1200, 1920)}) {
    const auto picture = reach_picture(example(), font(), width, height);
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->width(), width);
    EXPECT_EQ(picture->height(), height);
    EXPECT_EQ(decoded(*picture), link_of(example())) << width;
    if (const char* const folder = std::getenv("CYCLORAMA_SCREENSHOTS")) {
      const auto png = encode_png(without_alpha(*picture));
      ASSERT_TRUE(png);
      EXPECT_TRUE(write_file_atomically(fmt::format("{}/reach-{}x{}.png", folder, width, height), *png));
    }
  }
}

TEST(ReachPicture, speaks_each_language_and_keeps_its_code) {
  std::set<std::string> texts;
  for (const Catalogue& language : Catalogue::all()) {
    PageReach reach = example();
    reach.language = language.language();
    const auto picture = reach_picture(reach, font(), 1920, 1080);
    ASSERT_TRUE(picture);
    EXPECT_EQ(decoded(*picture), link_of(example())) << reach.language;
    EXPECT_TRUE(texts.insert(language.sentence("Operator page: scan the code, or enter")).second) << reach.language;
    if (const char* const folder = std::getenv("CYCLORAMA_SCREENSHOTS")) {
      const auto png = encode_png(without_alpha(*picture));
      ASSERT_TRUE(png);
      EXPECT_TRUE(write_file_atomically(fmt::format("{}/reach-{}.png", folder, reach.language), *png));
    }
  }
}

TEST(ReachPicture, is_drawn_for_every_size_and_any_text) {
  PageReach reach = example();
  reach.name.assign(200, 'W');
  reach.name.append("\xff\xf0\x9f");
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(16, 4000), std::pair(4000, 16), std::pair(160, 120)}) {
    EXPECT_TRUE(reach_picture(reach, font(), width, height)) << width;
  }
  const auto without = reach_picture(PageReach{}, font(), 640, 400);
  ASSERT_TRUE(without);
  EXPECT_EQ(decoded(*without), "");
  reach.addresses = {std::string(4000, 'x')};
  const auto too_long = reach_picture(reach, font(), 640, 400);
  ASSERT_FALSE(too_long);
  EXPECT_THAT(too_long.error().message(), HasSubstr("does not fit"));
}

TEST(TextFont, names_the_package_of_a_missing_font) {
  const auto missing = TextFont::open({"/nowhere.ttf"});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message(), HasSubstr("install fonts-dejavu-core"));
  EXPECT_FALSE(TextFont::open({"/etc/hostname"}));
  EXPECT_GT(font().width_px("洞窟", 40), font().width_px("洞", 40));
}

class ReachScreenTest : public ::testing::Test {
 protected:
  ReachScreenTest() {
    std::string name = (std::filesystem::temp_directory_path() / "reach-XXXXXX").string();
    CHECK(::mkdtemp(name.data()) != nullptr);
    folder_ = name;
  }
  ~ReachScreenTest() override { std::filesystem::remove_all(folder_); }
  void write(const PageReach& reach) const {
    ASSERT_TRUE(write_file_atomically(folder_ / "reach.json", std::string_view(to_json(reach))));
  }
  /// The file's time is set, since two presses may fall into one tick of the file system's clock.
  void press_help() {
    ASSERT_TRUE(write_file_atomically(folder_ / "help", std::string_view("x")));
    std::filesystem::last_write_time(folder_ / "help",
                                     std::filesystem::file_time_type(std::chrono::seconds(++presses_)));
  }
  [[nodiscard]] ReachScreen screen() const {
    const output::HeadMode head{.name = "left", .width_px = 320, .height_px = 200};
    return {folder_ / "reach.json", folder_ / "help", {head, head}};
  }
  std::filesystem::path folder_;
  int presses_ = 0;
};

TEST_F(ReachScreenTest, shows_nothing_while_all_is_well_and_pictures_after_help) {
  press_help();
  write(example());
  ReachScreen shown = screen();
  EXPECT_FALSE(shown.update(kNow)) << "a press before the start is over";
  press_help();
  EXPECT_FALSE(shown.update(kNow + 100ms)) << "the files are not read all the time";
  EXPECT_TRUE(shown.update(kNow + 1s));
  EXPECT_EQ(shown.pictures().size(), 2u);
  EXPECT_FALSE(shown.update(kNow + 2s)) << "the same picture";
  EXPECT_TRUE(shown.update(kNow + 3min));
  EXPECT_TRUE(shown.pictures().empty());
}

TEST_F(ReachScreenTest, shows_each_language_in_turn_until_the_museum_has_chosen_one) {
  PageReach reach = example();
  reach.has_pin = false;
  reach.language.clear();
  write(reach);
  ReachScreen shown = screen();
  int changes = 0;
  const int languages = static_cast<int>(Catalogue::all().size());
  for (TimePoint now = kNow; now < kNow + 2 * languages * kLanguageShown; now += 1s)
    changes += shown.update(now) ? 1 : 0;
  // A whole number of turns of kLanguageShown has passed at kNow only by chance.
  EXPECT_THAT(changes, ::testing::AnyOf(2 * languages, 2 * languages + 1));
  reach.language = "fr";
  write(reach);
  EXPECT_TRUE(shown.update(kNow + 1h));
  EXPECT_FALSE(shown.update(kNow + 2h));
}

TEST_F(ReachScreenTest, follows_the_file_until_the_first_pin) {
  ReachScreen shown = screen();
  EXPECT_FALSE(shown.update(TimePoint(1h))) << "no file yet";
  PageReach reach = example();
  reach.has_pin = false;
  write(reach);
  EXPECT_TRUE(shown.update(kNow));
  reach.answered_at = kNow + 10s;
  write(reach);
  EXPECT_FALSE(shown.update(kNow + 10s)) << "nothing that is shown has changed";
  reach.addresses.pop_back();
  write(reach);
  EXPECT_TRUE(shown.update(kNow + 20s));
  ASSERT_TRUE(write_file_atomically(folder_ / "reach.json", std::string_view("{")));
  EXPECT_FALSE(shown.update(kNow + 30s)) << "a damaged file changes nothing";
  reach.has_pin = true;
  write(reach);
  EXPECT_TRUE(shown.update(kNow + 40s));
  EXPECT_TRUE(shown.pictures().empty());
}

}  // namespace
}  // namespace cyclorama::display
