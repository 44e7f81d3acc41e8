// SPDX-License-Identifier: Apache-2.0
// The presenter beside other displays: it shows each frame at its synchronised refresh, or late with a report.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "appliance/display/presenter.h"
#include "tests/doubles/fake_clock.h"
#include "tests/support/painted_head.h"

namespace cyclorama::display {
namespace {

using namespace std::chrono_literals;

constexpr int kSide = 16;
constexpr Duration kPeriod = 10ms;
constexpr std::int64_t kPeriod_ns = 10'000'000;

/// Renders to memory, with a raster paced by the test's clock: pictures are begun 4 ms before their refresh.
class RasterOutput final : public output::Output {
 public:
  RasterOutput(std::unique_ptr<output::Output> memory, FakeClock* clock) : memory_(std::move(memory)), clock_(*clock) {}
  [[nodiscard]] const std::vector<output::HeadMode>& heads() const override { return memory_->heads(); }
  [[nodiscard]] double refresh_hz() const override { return 100.0; }
  [[nodiscard]] std::string kind() const override { return "raster"; }
  [[nodiscard]] const output::Gl& gl() const override { return memory_->gl(); }
  [[nodiscard]] const std::vector<output::HeadShown>& shown() const override { return memory_->shown(); }
  Status wait_for_refresh() override {
    clock_.set(start_ + static_cast<std::int64_t>(refresh_ + 1) * kPeriod - 4ms);
    return Done{};
  }
  Status draw_to(std::size_t head) override { return memory_->draw_to(head); }
  Result<output::Presented> present() override {
    TRY(memory_->present());
    refresh_ += 1 + std::exchange(missed, 0);
    clock_.set(start_ + static_cast<std::int64_t>(refresh_) * kPeriod);
    return output::Presented{refresh_, clock_.now()};
  }
  std::uint64_t missed = 0;  ///< Refreshes that the next picture misses.

 private:
  std::unique_ptr<output::Output> memory_;
  FakeClock& clock_;
  const TimePoint start_ = clock_.now();
  std::uint64_t refresh_ = 0;
};

/// The tour's clock is an hour behind; refresh 0 of the output is the tour's 0.
class SynchronisedPresenterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto memory = *output::open_headless_output({{{"a", kSide, kSide}}, 1000.0, {}, {}}, clock_);
    auto output = std::make_unique<RasterOutput>(std::move(memory), &clock_);
    output_ = std::move(output);
    warp::WarpMesh mesh{kSide, kSide, 1, 1, {}, 0.0};
    mesh.vertices = {
        {0, 0, -0.5f, 0.5f}, {kSide, 0, 0.5f, 0.5f}, {0, kSide, -0.5f, -0.5f}, {kSide, kSide, 0.5f, -0.5f}};
    std::vector<HeadPlan> plans(1, {mesh, warp::MaskImage(kSide, kSide, 1.0f)});
    plans.front().packing = packing_;
    const AttractTimes no_fade{std::chrono::hours(1), 1ms};
    auto presenter = Presenter::make(output_.get(), plans, *frame(0, 0), no_fade, &mailbox_, &clock_);
    ASSERT_TRUE(presenter) << presenter.error().message();
    presenter_ = *std::move(presenter);
    mailbox_.clock.put({true, static_cast<std::uint64_t>(-to_nanoseconds(clock_.now())), 0ns});
    refresh();
  }
  void TearDown() override { presenter_.reset(); }

  /// Returns a plain picture, whose code value is its order.
  static std::unique_ptr<DisplayFrame> frame(std::uint64_t order, std::int64_t refresh) {
    PlanarPicture picture(32, 16, false);
    std::ranges::fill(picture.luma().data(), static_cast<std::uint8_t>(5 * order));
    auto frame = std::make_unique<DisplayFrame>(PaintedHead::frame(picture, Panorama{32, 16, 1.4, 0.5, -0.5}, nullptr));
    frame->order = frame->number = order;
    frame->turn_limit_rad = 0.2;
    if (refresh != 0) frame->show_at = {refresh, kPeriod_ns, 0};
    return frame;
  }
  RefreshEvent refresh() {
    EXPECT_TRUE(presenter_->refresh());
    mailbox_.retired.clear([this](const DisplayFrame& unseen) { unseen_.push_back(unseen.number); });
    return mailbox_.refreshes.pop().value_or(RefreshEvent{});
  }
  /// Returns the frames first shown at the next refreshes, 0 if there is none, and their delays.
  std::vector<std::uint64_t> firsts(int refreshes, std::vector<std::int64_t>* ret_late = nullptr) {
    std::vector<std::uint64_t> numbers;
    for (int n = 0; n < refreshes; ++n) {
      const RefreshEvent event = refresh();
      numbers.push_back(event.is_first_of_frame ? event.frame_number : 0);
      if (ret_late != nullptr) ret_late->push_back(event.late(event.frame_due));
    }
    return numbers;
  }

  std::optional<StereoPacking> packing_;
  FakeClock clock_;
  PresentMailbox mailbox_{1};
  std::unique_ptr<RasterOutput> output_;
  std::unique_ptr<Presenter> presenter_;
  std::vector<std::uint64_t> unseen_;
};

TEST_F(SynchronisedPresenterTest, shows_each_frame_at_its_refresh) {
  mailbox_.frames.put(frame(1, 4));
  mailbox_.frames.put(frame(2, 6));
  std::vector<std::int64_t> late;
  EXPECT_THAT(firsts(6, &late), ::testing::ElementsAre(0, 0, 1, 0, 2, 0)) << "from refresh 2 on";
  EXPECT_THAT(late, ::testing::Each(0));
  EXPECT_THAT(unseen_, ::testing::IsEmpty());
}

TEST_F(SynchronisedPresenterTest, reports_synchronised_numbers_and_shows_the_frame_itself) {
  mailbox_.frames.put(frame(30, 3));
  mailbox_.heads[0].want([] { return std::make_unique<RgbImage>(kSide, kSide); });
  EXPECT_EQ(refresh().synchronised_refresh, 2);
  EXPECT_LT(mailbox_.heads[0].take()->at(8, 8)[1], 10) << "not before";
  mailbox_.heads[0].want([] { return std::make_unique<RgbImage>(kSide, kSide); });
  const RefreshEvent event = refresh();
  EXPECT_EQ(event.synchronised_refresh, 3);
  EXPECT_EQ(event.drawn_ahead, 4ms);
  refresh();
  mailbox_.heads[0].want([] { return std::make_unique<RgbImage>(kSide, kSide); });
  refresh();
  EXPECT_NEAR(mailbox_.heads[0].take()->at(8, 8)[1], 150, 2);
}

TEST_F(SynchronisedPresenterTest, shows_an_unready_frame_late_and_reports_the_delay) {
  firsts(5);  // Runs up to refresh 6.
  mailbox_.frames.put(frame(1, 4));
  const RefreshEvent event = refresh();
  EXPECT_TRUE(event.is_first_of_frame);
  EXPECT_EQ(event.late(event.frame_due), 3);
}

TEST_F(SynchronisedPresenterTest, reports_that_a_missed_refresh_made_a_frame_late) {
  mailbox_.frames.put(frame(1, 2));
  output_->missed = 2;
  const RefreshEvent event = refresh();
  EXPECT_EQ(event.synchronised_refresh, 4);
  EXPECT_EQ(event.late(event.frame_due), 2);
}

TEST_F(SynchronisedPresenterTest, skips_superseded_frames_and_counts_the_delay_from_the_first_missing_one) {
  firsts(5);
  mailbox_.frames.put(frame(2, 7));  // Decoded in another order than they came.
  mailbox_.frames.put(frame(1, 5));
  const RefreshEvent event = refresh();
  EXPECT_EQ(event.frame_number, 2U);
  EXPECT_EQ(event.late(event.frame_due), 2);
  EXPECT_THAT(unseen_, ::testing::ElementsAre(1));
  mailbox_.frames.put(frame(1, 5));
  EXPECT_FALSE(refresh().is_first_of_frame) << "older than what is shown";
  EXPECT_THAT(unseen_, ::testing::ElementsAre(1, 1));
}

TEST_F(SynchronisedPresenterTest, shows_an_unscheduled_frame_at_once) {
  mailbox_.frames.put(frame(1, 50));
  EXPECT_THAT(firsts(2), ::testing::Each(0));
  mailbox_.frames.put(frame(2, 0));  // The other displays have left.
  EXPECT_THAT(firsts(2), ::testing::ElementsAre(2, 0));
  EXPECT_THAT(unseen_, ::testing::ElementsAre(1));
}

TEST_F(SynchronisedPresenterTest, shows_a_frame_scheduled_by_another_clock_at_once) {
  mailbox_.frames.put(frame(1, 1'000'000));
  EXPECT_THAT(firsts(1), ::testing::ElementsAre(1));
  mailbox_.frames.put(frame(2, 20));
  EXPECT_THAT(firsts(1), ::testing::ElementsAre(0));
  mailbox_.clock.put({});  // The connection is lost.
  EXPECT_THAT(firsts(1), ::testing::ElementsAre(2));
}

TEST_F(SynchronisedPresenterTest, turns_to_each_heading_at_its_refresh_and_never_back) {
  mailbox_.frames.put(frame(1, 0));
  refresh();
  const auto told = [&](double heading_rad, std::int64_t refresh) {
    mailbox_.headings.put({heading_rad, 7, {refresh, kPeriod_ns, 0}});
  };
  told(0.01, 4);
  told(0.02, 5);
  told(0.03, 5);
  told(0.04, 7);
  std::vector<double> seen;
  std::vector<std::int64_t> shutters;
  for (int n = 0; n < 6; ++n) {
    const RefreshEvent event = refresh();
    seen.push_back(event.heading_rad);
    shutters.push_back(event.heading_shutter_ns);
    EXPECT_EQ(event.late(event.heading_due), 0);
  }
  EXPECT_THAT(seen, ::testing::ElementsAre(0.0, 0.01, 0.03, 0.03, 0.04, 0.04));
  EXPECT_THAT(shutters, ::testing::ElementsAre(0, 7, 7, 0, 7, 0)) << "each once";
  told(0.05, 6);
  const RefreshEvent late = refresh();
  EXPECT_EQ(late.heading_rad, 0.05);
  EXPECT_EQ(late.late(late.heading_due), 3);
  for (int n = 0; n < 40; ++n) told(0.001 * n, 10);  // More than are kept; the newest is present.
  EXPECT_EQ(refresh().heading_rad, 0.039);
}

TEST_F(SynchronisedPresenterTest, bounds_the_number_of_waiting_frames) {
  std::size_t untaken = 0;
  for (std::uint64_t n = 1; n <= 40; ++n) {
    untaken += mailbox_.frames.put(frame(n, 60)) != nullptr ? 1U : 0U;
    refresh();
  }
  EXPECT_EQ(untaken, 40U - 8 - 4) << "8 wait with the presenter, 4 before it";
  firsts(30);
  EXPECT_EQ(unseen_.size() + untaken + 2, 40U) << "each has one outcome";
}

/// A head that alternates the left and the right eye's picture.
class AlternatingPresenterTest : public SynchronisedPresenterTest {
 protected:
  AlternatingPresenterTest() { packing_ = StereoPacking::kFrameSequential; }
  static std::unique_ptr<DisplayFrame> frame_for_two(std::uint64_t order, std::int64_t refresh) {
    PlanarPicture picture(32, 32, false);
    const auto luma = picture.luma().data();
    std::fill(luma.begin(), luma.begin() + 512, std::uint8_t{200});
    std::fill(luma.begin() + 512, luma.end(), std::uint8_t{50});
    auto frame = std::make_unique<DisplayFrame>(PaintedHead::frame(picture, Panorama{32, 16, 1.4, 0.5, -0.5}, nullptr));
    frame->stacked = 2;
    frame->order = frame->number = order;
    frame->turn_limit_rad = 0.2;
    if (refresh != 0) frame->show_at = {refresh, kPeriod_ns, 0};
    return frame;
  }
  /// Returns the eye of the next refresh.
  Eye shown() {
    mailbox_.heads[0].want([] { return std::make_unique<RgbImage>(kSide, kSide); });
    event_ = refresh();
    const int code = mailbox_.heads[0].take()->at(8, 8)[1];
    EXPECT_TRUE(std::abs(code - 200) <= 2 || std::abs(code - 50) <= 2) << code;
    return code > 120 ? Eye::kLeft : Eye::kRight;
  }
  RefreshEvent event_;
};

TEST_F(AlternatingPresenterTest, shows_the_left_eye_at_even_synchronised_refreshes) {
  mailbox_.frames.put(frame_for_two(1, 1));
  refresh();  // Ends the attract picture.
  // From now on the tour's count is 1 ahead of this output's.
  mailbox_.clock.put({true, static_cast<std::uint64_t>(-to_nanoseconds(clock_.now()) + 2 * kPeriod_ns), 0ns});
  int turns[2] = {0, 0};
  for (int n = 0; n < 20; ++n) {
    const Eye eye = shown();
    ASSERT_TRUE(event_.synchronised_refresh);
    EXPECT_EQ(eye, eye_at(*event_.synchronised_refresh)) << *event_.synchronised_refresh;
    ++turns[eye == Eye::kLeft ? 0 : 1];
  }
  EXPECT_EQ(turns[0], 10);
  EXPECT_EQ(turns[1], 10);
}

TEST_F(AlternatingPresenterTest, keeps_the_eyes_in_order_after_missed_refreshes) {
  mailbox_.frames.put(frame_for_two(1, 1));
  refresh();  // Ends the attract picture.
  for (const std::uint64_t missed : {0U, 1U, 2U, 3U, 0U}) {
    output_->missed = missed;
    shown();  // A picture drawn for one refresh appears at a later one.
    for (int n = 0; n < 3; ++n) {
      const Eye eye = shown();
      ASSERT_TRUE(event_.synchronised_refresh);
      EXPECT_EQ(eye, eye_at(*event_.synchronised_refresh)) << missed << " missed";
    }
  }
}

TEST_F(AlternatingPresenterTest, counts_its_own_refreshes_without_a_synchronised_number) {
  mailbox_.clock.put({});
  mailbox_.frames.put(frame_for_two(1, 0));
  refresh();  // Ends the attract picture.
  for (int n = 0; n < 8; ++n) {
    const Eye eye = shown();
    EXPECT_FALSE(event_.synchronised_refresh);
    EXPECT_EQ(eye, eye_at(static_cast<std::int64_t>(event_.presented.refresh)));
  }
}

}  // namespace
}  // namespace cyclorama::display
