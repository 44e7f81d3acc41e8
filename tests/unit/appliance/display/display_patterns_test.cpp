// SPDX-License-Identifier: Apache-2.0
// A calibration's patterns on the heads of a whole display, and the show afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "appliance/display/display.h"
#include "appliance/display/reach_picture.h"
#include "common/base/file.h"
#include "common/image/image_file.h"
#include "common/image/png.h"
#include "common/wire/calibration.grpc.pb.h"
#include "drivers/output/shared_picture.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_tour.h"

namespace cyclorama::display {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;

constexpr int kWidth = 160;  // Size of the demo's heads, each side a quarter.
constexpr int kHeight = 120;

RgbImage noise(unsigned seed) {
  std::mt19937 random(seed);
  RgbImage picture(kWidth, kHeight);
  for (std::uint8_t& code : picture.data()) code = static_cast<std::uint8_t>(random());
  return picture;
}

std::string png_of(const RgbImage& picture) {
  const auto png = encode_png(picture);
  EXPECT_TRUE(png);
  return {reinterpret_cast<const char*>(png->data()), png->size()};
}

/// The calibrator's side of the stream.
class Patterns {
 public:
  explicit Patterns(int port) : stub_(wire::PatternScreen::NewStub(*make_channel("[::1]:" + std::to_string(port)))) {
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
    stream_ = stub_->ShowPatterns(&context_);
  }
  ~Patterns() {
    if (is_open_) context_.TryCancel();
    if (is_open_) stream_->Finish();
  }
  struct One {
    std::string projector;
    std::string png;
  };
  /// Returns whether the order was answered.
  bool show(std::uint32_t number, const std::vector<One>& heads, wire::PatternShown* ret_answer) {
    wire::PatternRequest order;
    order.set_number(number);
    for (const One& one : heads) {
      wire::HeadPattern* const pattern = order.add_heads();
      pattern->set_projector(one.projector);
      pattern->set_png(one.png);
    }
    return stream_->Write(order) && stream_->Read(ret_answer);
  }
  bool show(std::uint32_t number, const std::vector<One>& heads) {
    wire::PatternShown answer;
    return show(number, heads, &answer) && answer.number() == number;
  }
  grpc::Status end() {
    is_open_ = false;
    stream_->WritesDone();
    wire::PatternShown answer;
    while (stream_->Read(&answer)) {
    }
    return stream_->Finish();
  }
  void cancel() { context_.TryCancel(); }

 private:
  std::unique_ptr<wire::PatternScreen::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::PatternRequest, wire::PatternShown>> stream_;
  bool is_open_ = true;
};

class DisplayPatternsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/patterns.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    run_dir_ = folder;
    tour_ = FakeTour::start();
    DisplayOptions options;
    options.installation = demo_room_with_pixels_over(4);
    options.tour = tour_->address();
    options.output.run_dir = run_dir_;
    options.width_px = 512;
    options.refresh_hz = 60.0;
    options.attract_times.fade = std::chrono::milliseconds(50);
    options.patterns_idle = patterns_idle_;
    options.reach = run_dir_ / "reach.json";
    options.help_pressed = run_dir_ / "help";
    static_cast<void>(set_reach(true));
    options.hours = *OpeningHours::parse({"Tue 10:00-18:00"}, "UTC");
    options.system_clock = [this] { return std::chrono::system_clock::now() + system_ahead_.load(); };
    set_hour(12);
    auto display = Display::start(std::move(options), clock_);
    ASSERT_TRUE(display) << display.error().message();
    display_ = *std::move(display);
    serving_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) display_->serve(clock_.now() + std::chrono::milliseconds(20));
    });
  }
  void TearDown() override {
    if (serving_.joinable()) serving_.request_stop();
    if (serving_.joinable()) serving_.join();
    display_.reset();
    std::filesystem::remove_all(run_dir_);
  }

  /// Writes the operator page's file: it answers, and has a PIN or none.
  [[nodiscard]] PageReach set_reach(bool has_pin) const {
    PageReach reach;
    reach.name = "hall-3";
    reach.addresses = {"https://192.0.2.7:8443/"};
    reach.has_pin = has_pin;
    reach.answered_at = clock_.now();
    EXPECT_TRUE(write_file_atomically(run_dir_ / "reach.json", std::string_view(to_json(reach))));
    return reach;
  }
  void set_hour(int hour) {
    const WallTime midnight(std::chrono::sys_days(std::chrono::year(2026) / 11 / 24));  // A Tuesday.
    system_ahead_ = midnight + std::chrono::hours(hour) - std::chrono::system_clock::now();
  }
  /// Shows a picture with detail everywhere, fully faded in.
  void show_frame(std::uint64_t number, unsigned seed) {
    const Panorama wanted = demo_room().panorama(512);
    std::mt19937 random(seed);
    RgbImage picture(wanted.width_px, wanted.height_px);
    for (std::uint8_t& code : picture.data()) code = static_cast<std::uint8_t>(60 + random() % 128);
    ASSERT_TRUE(tour_->wait_for_display());
    tour_->send_all(frame_messages(number, picture, wanted));
    ASSERT_TRUE(tour_->wait_for_reports(number, 0));
    ASSERT_TRUE(wait_until_still());
  }
  RgbImage head(const std::string& name) {
    auto reader = output::SharedPictureReader::open(output::shared_picture_path(run_dir_, name));
    EXPECT_TRUE(reader);
    RgbImage picture;
    if (!reader || !reader->read_newest(&picture)) return RgbImage(kWidth, kHeight);
    return picture;
  }
  std::vector<RgbImage> heads() { return {head("left"), head("middle"), head("right")}; }
  bool wait_until(const std::function<bool()>& condition) {
    const TimePoint deadline = clock_.now() + std::chrono::seconds(20);
    while (!condition()) {
      if (clock_.now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }
  /// Waits until the picture stays unchanged for some refreshes.
  bool wait_until_still() {
    std::vector<RgbImage> before = heads();
    TimePoint since = clock_.now();
    return wait_until([&] {
      std::vector<RgbImage> now = heads();
      if (!(now == before)) since = clock_.now();
      before = std::move(now);
      return clock_.now() - since > std::chrono::milliseconds(300);
    });
  }
  std::string state() { return display_->inspection().status().state(); }

  Duration patterns_idle_ = std::chrono::minutes(10);
  SteadyClock clock_;
  std::atomic<std::chrono::nanoseconds> system_ahead_{};
  std::filesystem::path run_dir_;
  std::unique_ptr<FakeTour> tour_;
  std::unique_ptr<Display> display_;
  std::jthread serving_;
};

TEST_F(DisplayPatternsTest, shows_patterns_exactly_and_then_the_same_show_again) {
  show_frame(1, 1);
  const std::vector<RgbImage> show = heads();
  Patterns patterns(display_->port());
  const TimePoint begin = clock_.now();
  wire::PatternShown answer;
  ASSERT_TRUE(patterns.show(7, {{"middle", png_of(noise(5))}}, &answer));
  EXPECT_EQ(answer.number(), 7U);
  EXPECT_GE(answer.shown_ns(), to_nanoseconds(begin));
  EXPECT_LE(answer.shown_ns(), to_nanoseconds(clock_.now()));
  EXPECT_EQ(head("middle"), noise(5)) << "at once when it is answered";
  EXPECT_THAT(head("left").data(), Each(0));
  EXPECT_THAT(head("right").data(), Each(0));
  EXPECT_TRUE(wait_until([&] { return state().find("patterns") != std::string::npos; }));

  ASSERT_TRUE(patterns.show(8, {{"left", png_of(noise(6))}, {"right", png_of(noise(7))}}));
  EXPECT_EQ(head("left"), noise(6));
  EXPECT_EQ(head("middle"), noise(5)) << "those that are not named keep what they show";
  EXPECT_EQ(head("right"), noise(7));
  ASSERT_TRUE(patterns.show(9, {{"middle", ""}, {"right", png_of(noise(7))}}));
  EXPECT_THAT(head("middle").data(), Each(0));
  ASSERT_TRUE(patterns.show(10, {})) << "an order of nothing is answered, too";

  EXPECT_TRUE(patterns.end().ok());
  EXPECT_EQ(heads(), show) << "as soon as the call has ended";
}

TEST_F(DisplayPatternsTest, shows_how_to_reach_the_page_without_a_pin_but_not_during_a_calibration) {
  show_frame(1, 1);
  const std::vector<RgbImage> show = heads();
  const PageReach reach = set_reach(false);
  const auto font = TextFont::open_installed();
  ASSERT_TRUE(font) << font.error().message();
  const auto drawn = reach_picture(reach, *font, kWidth, kHeight);
  ASSERT_TRUE(drawn);
  const RgbImage help = without_alpha(*drawn);
  EXPECT_TRUE(wait_until([&] { return heads() == std::vector<RgbImage>{help, help, help}; }));
  {
    Patterns patterns(display_->port());
    ASSERT_TRUE(patterns.show(1, {{"middle", png_of(noise(5))}}));
    EXPECT_EQ(head("middle"), noise(5));
    EXPECT_THAT(head("left").data(), Each(0));
    EXPECT_TRUE(patterns.end().ok());
  }
  EXPECT_EQ(head("middle"), help) << "as soon as the call has ended";
  static_cast<void>(set_reach(true));
  EXPECT_TRUE(wait_until([&] { return heads() == show; }));
  ASSERT_TRUE(write_file_atomically(run_dir_ / "help", std::string_view("x")));
  EXPECT_TRUE(wait_until([&] { return heads() != show; }));
}

TEST_F(DisplayPatternsTest, shows_a_hundred_patterns_each_before_its_answer) {
  Patterns patterns(display_->port());
  for (unsigned n = 1; n <= 100; ++n) {
    const std::string name = std::array{"left", "middle", "right"}[n % 3];
    ASSERT_TRUE(patterns.show(n, {{name, png_of(noise(n))}}));
    ASSERT_EQ(head(name), noise(n)) << n;
  }
}

TEST_F(DisplayPatternsTest, returns_to_the_show_when_the_client_is_killed) {
  show_frame(1, 1);
  {
    Patterns patterns(display_->port());
    ASSERT_TRUE(patterns.show(1, {{"middle", png_of(noise(5))}}));
    const Panorama wanted = demo_room().panorama(512);
    tour_->send_all(frame_messages(2, RgbImage(wanted.width_px, wanted.height_px, 200), wanted));
    ASSERT_TRUE(tour_->wait_for_reports(2, 0));
    EXPECT_EQ(head("middle"), noise(5));
    patterns.cancel();
  }
  EXPECT_TRUE(wait_until([&] { return std::abs(head("middle").at(80, 60)[0] - 200) <= 4; })) << "the newest frame";
  EXPECT_TRUE(wait_until([&] { return state().find("Shows the tour") != std::string::npos; }));
}

TEST_F(DisplayPatternsTest, serves_one_calibration_at_a_time) {
  Patterns first(display_->port());
  ASSERT_TRUE(first.show(1, {{"left", png_of(noise(1))}}));
  Patterns second(display_->port());
  EXPECT_FALSE(second.show(1, {{"left", png_of(noise(2))}}));
  const grpc::Status refused = second.end();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("another calibration"));
  EXPECT_EQ(head("left"), noise(1));
  ASSERT_TRUE(first.show(2, {{"left", png_of(noise(3))}}));
  EXPECT_TRUE(first.end().ok());
  Patterns third(display_->port());
  EXPECT_TRUE(third.show(1, {{"left", png_of(noise(4))}}));
}

TEST_F(DisplayPatternsTest, refuses_wrong_patterns_with_a_reason_and_returns_to_the_show) {
  ASSERT_TRUE(wait_until_still());
  const std::vector<RgbImage> show = heads();
  std::string broken = png_of(noise(1));
  broken.resize(broken.size() / 2);
  RgbImage large(kWidth + 1, kHeight);
  const std::vector<std::pair<std::vector<Patterns::One>, std::string>> cases{
      {{{"attic", png_of(noise(1))}}, "'attic'"},
      {{{"left\n", png_of(noise(1))}}, "left"},
      {{{"left", png_of(RgbImage(kWidth, kHeight - 1))}}, "160x119"},
      {{{"left", png_of(large)}}, "160x120"},
      {{{"left", png_of(RgbImage(kHeight, kWidth))}}, "120x160"},
      {{{"left", broken}}, "'left'"},
      {{{"right", "no PNG at all"}}, "'right'"},
      {{{"left", ""}, {"left", ""}}, "twice"},
  };
  for (const auto& [heads_of_order, words] : cases) {
    Patterns patterns(display_->port());
    ASSERT_TRUE(patterns.show(1, {{"middle", png_of(noise(9))}}));
    EXPECT_FALSE(patterns.show(2, heads_of_order));
    const grpc::Status refused = patterns.end();
    EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << words;
    EXPECT_THAT(refused.error_message(), HasSubstr(words));
    EXPECT_EQ(heads(), show) << words;
  }
}

TEST_F(DisplayPatternsTest, wakes_the_heads_at_night_and_lets_them_sleep_again) {
  show_frame(1, 1);
  set_hour(23);
  ASSERT_TRUE(wait_until([&] { return state().find("Sleeps") != std::string::npos; }));
  ASSERT_TRUE(wait_until_still());
  EXPECT_THAT(head("middle").data(), Each(0));
  Patterns patterns(display_->port());
  ASSERT_TRUE(patterns.show(1, {{"middle", png_of(noise(5))}}));
  EXPECT_EQ(head("middle"), noise(5));
  EXPECT_TRUE(patterns.end().ok());
  EXPECT_TRUE(wait_until([&] { return state().find("Sleeps") != std::string::npos; }));
  ASSERT_TRUE(wait_until_still());
  EXPECT_THAT(head("middle").data(), Each(0));
}

class DisplayPatternsIdleTest : public DisplayPatternsTest {
 protected:
  DisplayPatternsIdleTest() { patterns_idle_ = std::chrono::milliseconds(400); }
};

TEST_F(DisplayPatternsIdleTest, returns_to_the_show_when_a_calibration_hangs) {
  show_frame(1, 1);
  const std::vector<RgbImage> show = heads();
  Patterns patterns(display_->port());
  for (unsigned n = 1; n <= 4; ++n) {  // Takes longer than `idle` altogether.
    ASSERT_TRUE(patterns.show(n, {{"middle", png_of(noise(n))}})) << n;
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
  }
  EXPECT_TRUE(wait_until([&] { return heads() == show; }));
  EXPECT_FALSE(patterns.show(5, {{"middle", png_of(noise(5))}}));
  EXPECT_EQ(patterns.end().error_code(), grpc::StatusCode::CANCELLED);
  Patterns next(display_->port());
  EXPECT_TRUE(next.show(1, {{"left", png_of(noise(1))}}));
}

TEST_F(DisplayPatternsTest, ends_the_call_when_the_display_stops) {
  Patterns patterns(display_->port());
  ASSERT_TRUE(patterns.show(1, {{"left", png_of(noise(1))}}));
  serving_.request_stop();
  serving_.join();
  const TimePoint begin = clock_.now();
  display_.reset();
  EXPECT_LT(clock_.now() - begin, std::chrono::seconds(10)) << "nobody waits for the calibrator";
  EXPECT_FALSE(patterns.end().ok());
}

}  // namespace
}  // namespace cyclorama::display
