// SPDX-License-Identifier: Apache-2.0
// The whole display in one process: a fake tour sends real JPEG tiles, the heads are read back.
#include "appliance/display/display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "common/base/file.h"
#include "drivers/output/shared_picture.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_tour.h"

namespace cyclorama::display {
namespace {

using ::testing::HasSubstr;

class DisplayTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = ::testing::TempDir() + "/display.XXXXXX";
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    run_dir_ = folder;
  }
  void TearDown() override {
    if (serving_.joinable()) serving_.request_stop();
    if (serving_.joinable()) serving_.join();
    display_.reset();
    std::filesystem::remove_all(run_dir_);
  }
  void start(const std::string& tour) {
    DisplayOptions options;
    options.installation = demo_room();
    options.tour = tour;
    options.output.run_dir = run_dir_;
    options.width_px = 512;
    options.refresh_hz = 60.0;
    options.hours = hours_;
    options.hours_override = run_dir_ / "hours-override";
    options.system_clock = [this] { return std::chrono::system_clock::now() + system_ahead_.load(); };
    auto display = Display::start(std::move(options), clock_);
    ASSERT_TRUE(display) << display.error().message();
    display_ = *std::move(display);
    wanted_ = demo_room().panorama(512);
    serving_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) display_->serve(clock_.now() + std::chrono::milliseconds(20));
    });
  }

  RgbImage head(const std::string& name) {
    auto reader = output::SharedPictureReader::open(output::shared_picture_path(run_dir_, name));
    EXPECT_TRUE(reader);
    RgbImage picture;
    // There is no picture before the first refresh.
    if (!reader || !reader->read_newest(&picture)) return RgbImage(640, 480);
    return picture;
  }
  /// The middle of the middle projector lights azimuth 0, where only the panorama's middle is visible, unblended.
  std::array<int, 3> middle_colour() {
    const RgbImage picture = head("middle");
    const std::uint8_t* const p = picture.at(320, 240);
    return {p[0], p[1], p[2]};
  }
  bool wait_until(const std::function<bool()>& condition) {
    const TimePoint deadline = clock_.now() + std::chrono::seconds(20);
    while (!condition()) {
      if (clock_.now() > deadline) return false;
      std::this_thread::yield();
    }
    return true;
  }
  bool wait_for_colour(std::array<int, 3> wanted) {
    return wait_until([&] {
      const auto seen = middle_colour();
      for (std::size_t c = 0; c < 3; ++c) {
        if (std::abs(seen[c] - wanted[c]) > 4) return false;
      }
      return true;
    });
  }
  double gauge(const std::string& name) {
    const wire::ProcessStatus status = display_->inspection().status();
    for (const wire::Gauge& gauge : status.gauges()) {
      if (gauge.name() == name) return gauge.value();
    }
    return -1.0;
  }
  RgbImage plain(const Panorama& panorama, std::array<std::uint8_t, 3> colour) {
    RgbImage picture(panorama.width_px, panorama.height_px);
    for (std::size_t i = 0; i < picture.data().size(); ++i) picture.data()[i] = colour[i % 3];
    return picture;
  }

  SteadyClock clock_;
  OpeningHours hours_;
  std::atomic<std::chrono::nanoseconds> system_ahead_{};
  std::filesystem::path run_dir_;
  Panorama wanted_;
  std::unique_ptr<Display> display_;
  std::jthread serving_;
};

TEST_F(DisplayTest, sends_hello_and_shows_the_attract_picture_before_the_first_frame) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  EXPECT_EQ(tour->hello.heads(), 3U);
  EXPECT_EQ(tour->hello.refresh_hz(), 60.0);
  EXPECT_EQ(*from_wire(tour->hello.wanted()), (Projection{wanted_, {}}));
  ASSERT_TRUE(wait_until([&] { return middle_colour()[0] > 0; }));
  const RgbImage picture = head("middle");
  EXPECT_LT(*std::ranges::max_element(picture.data()), 70);
  EXPECT_GT(*std::ranges::max_element(picture.data()), 20);
}

TEST_F(DisplayTest, shows_complete_frames_and_reports_each_once) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  for (std::uint64_t n = 1; n <= 3; ++n) {
    const auto shade = static_cast<std::uint8_t>(60 * n);
    tour->send_all(frame_messages(n, plain(wanted_, {shade, 100, 30}), wanted_));
    ASSERT_TRUE(tour->wait_for_reports(n, 0));
    ASSERT_TRUE(wait_for_colour({shade, 100, 30}));
  }
  ASSERT_EQ(tour->presented.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const wire::FramePresented& report = tour->presented[i];
    EXPECT_EQ(report.view_number(), i + 1);
    EXPECT_LE(report.presented_ns(), to_nanoseconds(clock_.now()));
    ASSERT_EQ(report.stages_size(), 3);
    EXPECT_EQ(report.stages(0).name(), "decode");
    EXPECT_EQ(report.stages(1).name(), "wait");
    EXPECT_EQ(report.stages(2).name(), "draw");
    for (const wire::StageTime& stage : report.stages()) {
      EXPECT_GE(stage.seconds(), 0.0);
      EXPECT_LT(stage.seconds(), 20.0);
    }
  }
  EXPECT_EQ(gauge("frames_presented"), 3.0);
  EXPECT_EQ(gauge("frames_dropped"), 0.0);
  EXPECT_GT(gauge("bytes_per_frame"), 1000.0);
}

TEST_F(DisplayTest, keeps_the_last_complete_frame_when_the_stream_breaks_and_reconnects) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  tour->send_all(frame_messages(1, plain(wanted_, {200, 40, 40}), wanted_));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));

  auto half = frame_messages(2, plain(wanted_, {40, 200, 40}), wanted_);
  half.resize(half.size() / 2);
  tour->send_all(half);
  tour->hang_up();
  ASSERT_TRUE(tour->wait_for_display());  // It reconnected by itself.
  EXPECT_EQ(tour->displays, 2);
  EXPECT_TRUE(wait_for_colour({200, 40, 40}));

  // A new session counts its views from 1 again.
  tour->send_all(frame_messages(1, plain(wanted_, {40, 40, 200}), wanted_));
  ASSERT_TRUE(tour->wait_for_reports(2, 0));
  EXPECT_TRUE(wait_for_colour({40, 40, 200}));
  EXPECT_TRUE(tour->dropped.empty());
}

TEST_F(DisplayTest, waits_for_a_tour_that_has_not_started_or_was_killed) {
  auto tour = FakeTour::start();
  const std::string address = tour->address();
  tour.reset();
  start(address);
  const auto says = [&](const std::string& words) {
    return wait_until(
        [&] { return std::string(display_->inspection().status().state()).find(words) != std::string::npos; });
  };
  EXPECT_TRUE(says("does not answer"));
  EXPECT_FALSE(display_->inspection().status().healthy());
  for (int life = 0; life < 2; ++life) {
    tour = FakeTour::start(address);
    ASSERT_TRUE(tour->wait_for_display());
    tour->send_all(frame_messages(1, plain(wanted_, {90, 90, 90}), wanted_));
    ASSERT_TRUE(tour->wait_for_reports(1, 0));
    EXPECT_TRUE(says("Shows the tour"));
    tour.reset();
    EXPECT_TRUE(says("does not answer"));
    EXPECT_TRUE(wait_for_colour({90, 90, 90}));
  }
}

TEST_F(DisplayTest, reconnects_after_an_invalid_message) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  tour->send_all(frame_messages(1, plain(wanted_, {200, 40, 40}), wanted_));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));
  wire::ShowMessage garbage;
  garbage.mutable_end()->add_stages()->set_name("\xff");  // A string that is not UTF-8 makes the message invalid.
  ASSERT_TRUE(tour->send(garbage));
  EXPECT_TRUE(wait_until([&] {
    return std::string(display_->inspection().status().state()).find("cannot be read") != std::string::npos;
  }));
  EXPECT_TRUE(wait_for_colour({200, 40, 40}));
  ASSERT_TRUE(tour->wait_for_display());
  EXPECT_EQ(tour->displays, 2);
}

TEST_F(DisplayTest, reports_a_damaged_frame_and_keeps_the_old_one) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  tour->send_all(frame_messages(1, plain(wanted_, {200, 40, 40}), wanted_));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));
  auto bad = frame_messages(2, plain(wanted_, {40, 200, 40}), wanted_);
  bad[2].mutable_tile()->mutable_jpeg()->resize(100);
  tour->send_all(bad);
  ASSERT_TRUE(tour->wait_for_reports(1, 1));
  EXPECT_EQ(tour->dropped[0].view_number(), 2U);
  EXPECT_THAT(tour->dropped[0].reason(), HasSubstr("JPEG"));
  EXPECT_TRUE(wait_for_colour({200, 40, 40}));
  EXPECT_EQ(gauge("frames_dropped"), 1.0);
}

TEST_F(DisplayTest, turns_its_frame_to_the_newest_heading) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  // Left half red, right half blue, for heading 1; a guard band of 0.3 rad.
  const Panorama guarded = wanted_.with_guard_band(0.3);
  RgbImage halves(guarded.width_px, guarded.height_px);
  for (int y = 0; y < halves.height(); ++y) {
    for (int x = 0; x < halves.width(); ++x) {
      halves.at(x, y)[0] = x < halves.width() / 2 ? 220 : 10;
      halves.at(x, y)[1] = 10;
      halves.at(x, y)[2] = x < halves.width() / 2 ? 10 : 220;
    }
  }
  tour->send_all(frame_messages(5, halves, guarded, 1.0));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));
  tour->send_heading(1.2, 0);  // A turn to the right moves the right part to the middle.
  EXPECT_TRUE(wait_for_colour({10, 10, 220}));
  EXPECT_EQ(gauge("refreshes_past_guard_band"), 0.0);
  tour->send_heading(0.8, to_nanoseconds(clock_.now()));
  EXPECT_TRUE(wait_for_colour({220, 10, 10}));
  tour->send_heading(1.0 + 1.5, 0);  // Beyond the guard band; the turn stops at its edge.
  EXPECT_TRUE(wait_for_colour({10, 10, 220}));
  EXPECT_TRUE(wait_until([&] { return gauge("refreshes_past_guard_band") > 0.0; }));
  tour->send_heading(std::numeric_limits<double>::quiet_NaN(), 0);
  tour->send_heading(0.8, 0);
  EXPECT_TRUE(wait_for_colour({220, 10, 10}));
  bool has_heading_time = false;
  const wire::ProcessStatus status = display_->inspection().status();
  for (const wire::Stage& stage : status.stages()) {
    has_heading_time = has_heading_time || (stage.name() == "heading_to_photon" && stage.count() == 1);
  }
  EXPECT_TRUE(has_heading_time);
}

TEST_F(DisplayTest, measures_the_tours_clock_and_shows_frames_at_the_scheduled_refresh) {
  const auto tour = FakeTour::start();
  system_ahead_ = std::chrono::milliseconds(250);
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  tour->send_heading(0.0, 0);  // The display only counts a tour as connected once it has sent something.
  ASSERT_TRUE(tour->wait_for_questions(16));
  EXPECT_TRUE(wait_until([&] { return std::abs(gauge("clock_skew_ms") - 250.0) <= gauge("clock_error_ms") + 5.0; }));
  constexpr std::int64_t kPeriod_ns = 16'666'667;
  const auto send_in = [&](std::uint64_t number, std::chrono::milliseconds lead) {
    const std::int64_t now_ns = FakeTour::now_ns();
    auto messages = frame_messages(number, plain(wanted_, {static_cast<std::uint8_t>(50 * number), 9, 9}), wanted_);
    wire::ShowAt* const at = messages.back().mutable_show_at();
    at->set_period_ns(kPeriod_ns);
    at->set_told_ns(now_ns);
    at->set_refresh((now_ns + std::chrono::nanoseconds(lead).count()) / kPeriod_ns);
    tour->send_all(messages);
    return at->refresh();
  };
  const std::int64_t due = send_in(1, std::chrono::milliseconds(400));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));
  // It is shown neither before its refresh nor, on a machine that keeps up, after it.
  const std::int64_t shown_ns = tour->presented[0].presented_ns() + (FakeTour::now_ns() - to_nanoseconds(clock_.now()));
  EXPECT_GE(static_cast<double>(shown_ns) / kPeriod_ns, static_cast<double>(due) - 1.0);
  send_in(2, std::chrono::milliseconds(-200));
  ASSERT_TRUE(tour->wait_for_reports(2, 0));
  EXPECT_TRUE(wait_until([&] { return gauge("frames_late") >= 1.0; })) << "told when it was too late";
  EXPECT_TRUE(wait_until([&] { return gauge("synchronised_percent") < 100.0; }));
  EXPECT_TRUE(wait_until([&] {
    return display_->inspection().status().state().find("synchronised with the other displays") != std::string::npos;
  }));
  // A need that the clock's error makes negative counts as zero, so one frame may not suffice: on a busy machine the
  // error is large.
  std::uint64_t number = 3;
  EXPECT_TRUE(wait_until([&] {
    send_in(number++, std::chrono::milliseconds(100));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return tour->has_question([](const auto& question) { return question.frame_need_s() > 0.0; });
  }));
}

TEST_F(DisplayTest, renders_pictures_for_watchers) {
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  tour->send_all(frame_messages(1, plain(wanted_, {200, 40, 40}), wanted_));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));
  auto channel = make_channel("[::1]:" + std::to_string(display_->port()));
  ASSERT_TRUE(channel);
  const auto stub = wire::Inspection::NewStub(*channel);
  for (const auto& [name, width] :
       {std::pair<std::string, unsigned>{"panorama", 512}, {"projector/left", 640}, {"projector/right", 640}}) {
    wire::Picture picture;
    EXPECT_TRUE(wait_until([&, wanted = name] {
      grpc::ClientContext context;
      wire::PictureRequest request;
      request.set_name(wanted);
      return stub->GetPicture(&context, request, &picture).ok();
    })) << name;
    EXPECT_EQ(picture.width_px(), width);
  }
  const wire::ProcessStatus status = display_->inspection().status();
  std::vector<std::string> facts;
  for (const wire::Fact& fact : status.facts()) facts.push_back(fact.name());
  EXPECT_THAT(facts, ::testing::IsSupersetOf({"gl_renderer", "output", "warp_vertices"}));
}

TEST_F(DisplayTest, is_dark_outside_opening_hours_and_shows_the_newest_frame_when_it_opens) {
  hours_ = *OpeningHours::parse({"Tue 10:00-18:00"}, "UTC");
  const WallTime midnight(std::chrono::sys_days(std::chrono::year(2026) / 11 / 24));  // A Tuesday.
  const auto set_system_clock = [&](WallTime time) { system_ahead_ = time - std::chrono::system_clock::now(); };
  set_system_clock(midnight);
  const auto tour = FakeTour::start();
  start(tour->address());
  ASSERT_TRUE(tour->wait_for_display());
  tour->send_all(frame_messages(1, plain(wanted_, {200, 40, 40}), wanted_));
  ASSERT_TRUE(tour->wait_for_reports(1, 0));
  const auto says = [&](const std::string& words) {
    return wait_until(
        [&] { return std::string(display_->inspection().status().state()).find(words) != std::string::npos; });
  };
  EXPECT_TRUE(says("Sleeps"));
  EXPECT_TRUE(display_->inspection().status().healthy());
  EXPECT_TRUE(wait_for_colour({0, 0, 0}));
  for (int day = 0; day < 2; ++day) {
    set_system_clock(midnight + std::chrono::hours(24 * 7 * day + 12));
    EXPECT_TRUE(wait_for_colour({200, 40, 40}));
    EXPECT_TRUE(says("Shows the tour"));
    set_system_clock(midnight + std::chrono::hours(24 * 7 * day + 19));
    EXPECT_TRUE(wait_for_colour({0, 0, 0}));
    EXPECT_TRUE(says("Sleeps"));
  }
  // An override keeps the museum open once, and ends by itself.
  const WallTime evening = midnight + std::chrono::hours(24 * 7 * 2 + 19);
  const HoursOverride open{true, evening - std::chrono::hours(1), evening + std::chrono::hours(1)};
  set_system_clock(evening);
  EXPECT_TRUE(write_file_atomically(run_dir_ / "hours-override", std::string_view(to_text(open))));
  EXPECT_TRUE(wait_for_colour({200, 40, 40}));
  set_system_clock(open.until);
  EXPECT_TRUE(says("Sleeps"));
}

TEST(Display, refuses_options_that_cannot_work) {
  SteadyClock clock;
  const auto code_of = [&](const auto& change) {
    DisplayOptions options;
    options.installation = demo_room();
    options.tour = "[::1]:7402";
    change(&options);
    const auto display = Display::start(std::move(options), clock);
    EXPECT_FALSE(display);
    return display.error().code();
  };
  EXPECT_EQ(code_of([](DisplayOptions* o) { o->tour = "::1"; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](DisplayOptions* o) { o->listen = "nonsense"; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](DisplayOptions* o) { o->width_px = 0; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](DisplayOptions* o) { o->refresh_hz = -1.0; }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([](DisplayOptions* o) { o->output.run_dir = "/nowhere/at/all"; }), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama::display
