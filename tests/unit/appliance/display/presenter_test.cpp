// SPDX-License-Identifier: Apache-2.0
// Tests the present thread's inner part: its pictures, and that it allocates nothing.
#include "appliance/display/presenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>
#include <vector>

#include "tests/doubles/fake_clock.h"
#include "tests/support/painted_head.h"
#include "tests/support/plain_show.h"

namespace {
thread_local bool is_counting = false;
thread_local int allocations = 0;
}  // namespace

// Counts every `new` and `delete` of the process, including the driver's C++.
void* operator new(std::size_t size) {
  if (is_counting) ++allocations;
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) std::abort();
  return memory;
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return operator new(size); }
void operator delete(void* memory) noexcept {
  if (is_counting && memory != nullptr) ++allocations;
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }

namespace cyclorama::display {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// Gives a frame the distances of a room with a pillar.
void add_mesh(DisplayFrame* frame) {
  const Projection picture{frame->shape, {}};
  const PixelRect cells = depth_cells({0, 0, picture.width_px(), picture.height_px()});
  InverseDepthImage depth(cells.width, cells.height, inverse_depth_of(3.0f));
  for (int y = 0; y < cells.height; ++y) *depth.at(cells.width / 2, y) = inverse_depth_of(0.7f);
  frame->mesh =
      std::make_shared<const ReprojectionMesh>(std::make_shared<const ReprojectionGrid>(picture, kDepthCellPx), depth);
}

class PresenterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    output_ = *output::open_headless_output({{{"a", kWidth, kHeight}, {"b", kWidth, kHeight}}, 1000.0, {}, {}}, clock_);
    const std::vector<HeadPlan> plans(2, plain_head(kWidth, kHeight));
    const AttractTimes times{std::chrono::milliseconds(100), std::chrono::milliseconds(200)};
    auto presenter = Presenter::make(output_.get(), plans, *frame_of(0, plain(32, 16, 0)), times, &mailbox_, &clock_);
    ASSERT_TRUE(presenter) << presenter.error().message();
    presenter_ = *std::move(presenter);
  }
  void TearDown() override { presenter_.reset(); }

  RefreshEvent refresh() {
    clock_.advance(std::chrono::milliseconds(10));
    is_counting = true;
    const Status status = presenter_->refresh();
    is_counting = false;
    EXPECT_TRUE(status);
    mailbox_.retired.clear([](const DisplayFrame&) {});
    const RefreshEvent event = mailbox_.refreshes.pop().value_or(RefreshEvent{});
    presented_ += event.is_first_of_frame ? 1 : 0;
    return event;
  }
  /// Returns the picture of the next refresh on a head.
  RgbImage shown(std::size_t head = 0) {
    mailbox_.heads[head].want([] { return std::make_unique<RgbImage>(kWidth, kHeight); });
    refresh();
    const auto picture = mailbox_.heads[head].take();
    EXPECT_NE(picture, nullptr);
    return picture == nullptr ? RgbImage(1, 1) : *picture;
  }
  void refresh_for(std::chrono::milliseconds time) {
    for (int n = 0; n < time.count() / 10; ++n) refresh();
  }

  FakeClock clock_;
  PresentMailbox mailbox_{2};
  std::unique_ptr<output::Output> output_;
  std::unique_ptr<Presenter> presenter_;
  int presented_ = 0;
};

TEST_F(PresenterTest, does_not_allocate_during_a_thousand_refreshes) {
  RandomHeads heads(1);
  std::vector<std::unique_ptr<DisplayFrame>> frames;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const int scale = 1 + static_cast<int>(n % 3);
    auto frame = frame_of(n + 1, heads.noise(40 * scale + 1, 16 * scale, n % 2 == 0), heads.between(-0.1, 0.1));
    if (n % 5 == 0) frame->parts = std::make_shared<const std::vector<PixelRect>>(1, PixelRect{16, 0, 16, 16});
    if (n % 3 != 0) add_mesh(frame.get());
    frames.push_back(std::move(frame));
  }
  // Half of them are due at once, the others two to five refreshes later, synchronised with other displays.
  std::uint64_t order = 0;
  const auto soon = [&](int n) {
    const std::int64_t now = to_nanoseconds(clock_.now()) / 10'000'000;
    return n / 8 % 2 == 0 ? ShowAt{} : ShowAt{now + 2 + n % 4, 10'000'000, 0};
  };
  const auto run = [&](int refreshes) {
    for (int n = 0; n < refreshes; ++n) {
      if (n % 4 == 0 && !frames.empty()) {
        frames.back()->order = ++order;
        frames.back()->show_at = soon(n);
        mailbox_.frames.put(std::move(frames.back()));
        frames.pop_back();
      }
      mailbox_.clock.put({true, 0, {}});
      HeadingNow pose{heads.between(-0.5, 0.5), n, soon(n)};
      pose.eye_m = {heads.between(-0.2, 0.2), 0.0, heads.between(-0.2, 0.2)};
      mailbox_.headings.put(pose);
      if (n % 50 == 0) mailbox_.panorama.want([] { return std::make_unique<DisplayFrame>(); });
      if (n % 50 == 25) mailbox_.heads[1].want([] { return std::make_unique<RgbImage>(kWidth, kHeight); });
      refresh();
      mailbox_.panorama.take();
      mailbox_.heads[1].take();
    }
  };
  run(40);  // The largest sizes arrive, and the first picture fades in.
  allocations = 0;
  run(1000);
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(presented_, 200);
  frames.clear();
  is_counting = true;
  int* volatile counted = new int;  // Proves that the counter works.
  delete counted;
  is_counting = false;
  EXPECT_EQ(allocations, 2);
}

TEST_F(PresenterTest, does_not_allocate_for_captions_after_the_largest) {
  const auto write = [&](int width, int height) {
    auto caption = std::make_unique<Caption>();
    caption->ink = GreyImage(width, height, 200);
    caption->width = 0.5;
    caption->height = 0.2;
    mailbox_.captions.wanted.put(std::move(caption));
    refresh_for(std::chrono::milliseconds(700));
    mailbox_.captions.replaced.take();
  };
  mailbox_.frames.put(frame_of(1, plain(32, 16, 90)));
  write(64, 32);
  write(60, 30);
  allocations = 0;
  for (int n = 1; n < 20; ++n) write(n % 5 == 0 ? 0 : 3 * n, n % 5 == 0 ? 0 : 32 - n);
  EXPECT_EQ(allocations, 0);
}

TEST(PresenterStart, tests_its_shaders_on_a_few_pixels_of_each_head) {
  const FakeClock clock;
  const auto output =
      *output::open_headless_output({{{"a", kWidth, kHeight}, {"b", kWidth, kHeight}}, 1000.0, {}, {}}, clock);
  const output::Gl& gl = output->gl();
  const auto untouched = [&](std::size_t head) {
    EXPECT_TRUE(output->draw_to(head));
    std::vector<std::array<std::uint8_t, 4>> pixels(std::size_t{kWidth} * kHeight);
    gl.ReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return std::ranges::count(pixels, std::array<std::uint8_t, 4>{255, 0, 255, 255});
  };
  for (const std::size_t head : {0U, 1U}) {
    ASSERT_TRUE(output->draw_to(head));
    gl.ClearColor(1.0f, 0.0f, 1.0f, 1.0f);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    ASSERT_EQ(untouched(head), kWidth * kHeight);
  }
  const auto plans = std::make_shared<const std::vector<HeadPlan>>(2, plain_head(kWidth, kHeight));
  PresentMailbox mailbox(2);
  const auto presenter =
      Presenter::make(output.get(), plans, true, *frame_of(0, plain(32, 16, 0)), AttractTimes{}, &mailbox, &clock);
  ASSERT_TRUE(presenter) << presenter.error().message();
  for (const std::size_t head : {0U, 1U}) {
    EXPECT_GT(untouched(head), kWidth * kHeight * 9 / 10);
    EXPECT_LT(untouched(head), kWidth * kHeight);  // It did draw.
  }
}

TEST_F(PresenterTest, shows_each_frame_whole_and_never_parts_of_two) {
  mailbox_.frames.put(frame_of(1, plain(80, 40, 50)));
  refresh_for(std::chrono::milliseconds(400));
  for (std::uint64_t n = 2; n < 40; ++n) {
    const auto code = static_cast<std::uint8_t>(50 + 5 * n);
    mailbox_.frames.put(frame_of(n, plain(80 + static_cast<int>(n % 3), 40, code, n % 2 == 0)));
    const RgbImage picture = shown(n % 2);
    ASSERT_THAT(picture.data(), ::testing::Each(::testing::AllOf(::testing::Ge(code - 1), ::testing::Le(code + 1))))
        << n;
  }
}

TEST_F(PresenterTest, repeats_the_last_frame_at_the_newest_heading) {
  PlanarPicture halves(140, 20, false);
  for (int y = 0; y < 20; ++y) std::fill_n(halves.luma().at(70, y), 70, std::uint8_t{255});
  mailbox_.frames.put(frame_of(1, halves, 1.0));
  mailbox_.headings.put({1.0, 0});
  refresh_for(std::chrono::milliseconds(300));
  const auto edge = [&] {  // Position where white begins.
    const RgbImage picture = shown();
    int x = 0;
    while (x < kWidth && picture.at(x, 20)[1] < 128) ++x;
    return x;
  };
  EXPECT_NEAR(edge(), 32, 1);
  mailbox_.headings.put({1.1, 0});  // A tenth of a radian to the right.
  EXPECT_NEAR(edge(), 32 - 6, 1);
  mailbox_.headings.put({0.9, 0});
  EXPECT_NEAR(edge(), 32 + 6, 1);
  mailbox_.headings.put({-1.0, 0});  // Farther than the picture extends.
  EXPECT_NEAR(edge(), 32 + 13, 1);
}

TEST_F(PresenterTest, moves_the_last_frame_to_the_visitors_eye) {
  PlanarPicture halves(140, 20, false);
  for (int y = 0; y < 20; ++y) std::fill_n(halves.luma().at(70, y), 70, std::uint8_t{255});
  auto frame = frame_of(1, halves, 0.0);
  const Projection picture{frame->shape, {}};
  frame->mesh =
      std::make_shared<const ReprojectionMesh>(std::make_shared<const ReprojectionGrid>(picture, kDepthCellPx),
                                               InverseDepthImage(35, 5, inverse_depth_of(2.0f)));
  frame->eye_m = {5.0, 1.5, 7.0};
  mailbox_.frames.put(std::move(frame));
  const auto go_to = [&](double x, double z) {
    HeadingNow pose;
    pose.eye_m = {x, 1.5, z};
    mailbox_.headings.put(pose);
  };
  go_to(5.0, 7.0);
  refresh_for(std::chrono::milliseconds(300));
  const RgbImage at_rest = shown();
  const auto edge = [](const RgbImage& seen) {  // Position where white begins.
    int x = 0;
    while (x < kWidth && seen.at(x, 20)[1] < 128) ++x;
    return x;
  };
  EXPECT_NEAR(edge(at_rest), 32, 1);
  go_to(5.2, 7.0);  // To the right: what is 2 m ahead moves to the left by a tenth of a radian.
  EXPECT_NEAR(edge(shown()), 32 - 6, 1);
  EXPECT_NEAR(refresh().moved_m, 0.2, 1e-9);
  go_to(9.0, 7.0);  // Another stop of the tour: nothing is moved.
  EXPECT_EQ(shown(), at_rest);
  EXPECT_NEAR(refresh().missed_m, 4.0, 1e-9);
  go_to(5.0, 7.0);
  EXPECT_EQ(shown(), at_rest);
}

TEST_F(PresenterTest, fades_in_a_frame_that_refines_the_one_before) {
  const auto put = [&](std::uint64_t n, std::uint8_t code) {
    auto frame = frame_of(n, plain(80, 40, code));
    add_mesh(frame.get());
    mailbox_.frames.put(std::move(frame));
  };
  const auto middle = [&] { return int{shown().at(kWidth / 2, kHeight / 2)[1]}; };
  put(1, 100);
  refresh_for(std::chrono::milliseconds(400));
  EXPECT_NEAR(middle(), 100, 1);
  put(2, 160);
  int last = middle();
  EXPECT_NEAR(last, 100, 1);
  for (int refreshes = 1; refreshes <= 30; ++refreshes) {
    const int now = middle();
    EXPECT_LE(now - last, 5) << refreshes;
    EXPECT_GE(now, last) << refreshes;
    last = now;
  }
  EXPECT_NEAR(last, 160, 1);
  EXPECT_NEAR(middle(), 160, 1);
}

TEST_F(PresenterTest, fades_to_a_frame_of_another_place_and_turns_it_by_headings_of_that_place_alone) {
  const auto put = [&](std::uint64_t order, std::uint8_t grey, double heading_rad, std::uint64_t cuts) {
    auto frame = frame_of(order, plain(140, 20, grey), heading_rad);
    frame->cuts = cuts;
    mailbox_.frames.put(std::move(frame));
  };
  const auto look = [&](double heading_rad, std::uint64_t cuts) {
    HeadingNow heading{heading_rad, 0};
    heading.cuts = cuts;
    mailbox_.headings.put(heading);
  };
  const auto code = [&] { return int{shown().at(kWidth / 2, 20)[1]}; };
  put(1, 40, 0.0, 7);
  look(0.0, 7);
  refresh_for(std::chrono::milliseconds(300));
  const int before = code();

  look(1.9, 8);  // The pose at the next place arrives before its first frame.
  EXPECT_EQ(refresh().turn_rad, 0.0);
  put(2, 220, 1.9, 8);
  int last = code();
  EXPECT_NEAR(last, before, 2) << "the cut begins with the place that is left";
  EXPECT_GT(refresh().cut_share, 0.9);
  for (int n = 0; n < 85; ++n) {
    const int now = code();
    EXPECT_GE(now, last);
    EXPECT_LE(now - last, 12) << "soft";
    last = now;
  }
  EXPECT_EQ(refresh().cut_share, 0.0);
  EXPECT_GT(last, before + 100);
  look(0.0, 7);  // A late pose at the place that was left.
  EXPECT_EQ(refresh().turn_rad, 0.0);
  look(2.0, 8);
  EXPECT_NEAR(refresh().turn_rad, 0.1, 1e-9);
  put(3, 220, 2.0, 8);
  refresh();
  EXPECT_EQ(refresh().cut_share, 0.0) << "another frame of the same place";
}

TEST_F(PresenterTest, holds_a_frame_without_depth_at_its_own_eye) {
  mailbox_.frames.put(frame_of(1, plain(40, 20, 100)));
  HeadingNow pose;
  pose.eye_m = {0.3, 0.0, 0.0};
  mailbox_.headings.put(pose);
  const RefreshEvent event = refresh();
  EXPECT_EQ(event.moved_m, 0.0);
  EXPECT_NEAR(event.missed_m, 0.3, 1e-9);
}

TEST_F(PresenterTest, keeps_its_picture_while_retired_frames_are_not_freed) {
  for (std::uint64_t n = 1; n <= 12; ++n) {
    mailbox_.frames.put(frame_of(n, plain(40, 20, 100)));
    clock_.advance(std::chrono::milliseconds(10));
    ASSERT_TRUE(presenter_->refresh());
  }
  int firsts = 0;
  while (const auto event = mailbox_.refreshes.pop()) firsts += event->is_first_of_frame ? 1 : 0;
  EXPECT_EQ(firsts, 9);  // 8 frames wait to be freed, the ninth is shown.
  mailbox_.retired.clear([](const DisplayFrame&) {});
  EXPECT_TRUE(refresh().is_first_of_frame);
}

std::unique_ptr<PatternWall> pattern_wall(std::uint64_t order, bool is_open,
                                          std::vector<std::shared_ptr<const RgbaImage>> pictures) {
  auto wall = std::make_unique<PatternWall>();
  wall->order = order;
  wall->is_open = is_open;
  for (auto& picture : pictures) wall->heads.push_back({std::move(picture), true});
  return wall;
}

TEST_F(PresenterTest, does_not_allocate_for_patterns_and_answers_each_with_its_first_refresh) {
  const auto picture = [](std::uint8_t code) { return std::make_shared<RgbaImage>(kWidth, kHeight, code); };
  std::vector<std::unique_ptr<PatternWall>> walls;
  for (std::uint64_t n = 1; n <= 200; ++n) {
    const auto code = static_cast<std::uint8_t>(n);
    walls.push_back(pattern_wall(n, n % 10 != 0, {picture(code), n % 3 == 0 ? nullptr : picture(255 - code)}));
  }
  mailbox_.frames.put(frame_of(1, plain(80, 40, 100)));
  refresh_for(std::chrono::milliseconds(400));
  PatternsShown told;
  for (std::size_t n = 0; n < walls.size(); ++n) {
    if (n == 10) allocations = 0;  // Each head has had its first pattern.
    mailbox_.patterns.wanted.put(std::move(walls[n]));
    refresh();
    ASSERT_TRUE(mailbox_.patterns.shown.take(&told)) << n;
    EXPECT_EQ(told.order, n + 1);
    EXPECT_EQ(told.lacking, 0U);
    mailbox_.patterns.replaced.take();
    refresh();
    EXPECT_FALSE(mailbox_.patterns.shown.take(&told)) << "once";
  }
  EXPECT_EQ(allocations, 0);
}

TEST_F(PresenterTest, returns_to_the_same_frame_after_patterns_which_watchers_see) {
  RandomHeads heads(3);
  mailbox_.frames.put(frame_of(1, heads.noise(80, 40, false)));
  refresh_for(std::chrono::milliseconds(400));
  const RgbImage show = shown();
  auto pattern = std::make_shared<RgbaImage>(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) pattern->at(x, y)[c] = static_cast<std::uint8_t>(3 * x + 5 * y + 50 * c);
    }
  }
  mailbox_.patterns.wanted.put(pattern_wall(1, true, {pattern, nullptr}));
  const RgbImage seen = shown();
  bool is_same = true;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) is_same = is_same && seen.at(x, y)[c] == pattern->at(x, y)[c];
    }
  }
  EXPECT_TRUE(is_same) << "code for code";
  EXPECT_THAT(shown(1).data(), ::testing::Each(0));
  mailbox_.patterns.replaced.take();
  mailbox_.patterns.wanted.put(pattern_wall(2, false, {nullptr, nullptr}));
  EXPECT_EQ(shown(), show);
}

TEST_F(PresenterTest, keeps_the_patterns_while_retired_ones_are_not_freed) {
  const auto wall = [](std::uint64_t order) {
    return pattern_wall(order, true, {std::make_shared<RgbaImage>(kWidth, kHeight, 7), nullptr});
  };
  PatternsShown told;
  for (std::uint64_t n = 1; n <= 5; ++n) {
    mailbox_.patterns.wanted.put(wall(n));
    refresh();
    mailbox_.patterns.shown.take(&told);
  }
  EXPECT_EQ(told.order, 2U) << "the second replaced the first, which nobody frees";
  mailbox_.patterns.replaced.take();
  refresh();
  mailbox_.patterns.shown.take(&told);
  EXPECT_EQ(told.order, 5U) << "the newest wins";
}

std::unique_ptr<HeadSet> heads_with_mask(float mask) {
  std::vector<HeadPlan> plans(2, plain_head(kWidth, kHeight));
  for (HeadPlan& plan : plans) plan.mask = warp::MaskImage(kWidth, kHeight, mask);
  return std::make_unique<HeadSet>(std::make_shared<const std::vector<HeadPlan>>(std::move(plans)));
}

class HeadChangeTest : public PresenterTest {
 protected:
  void SetUp() override {
    PresenterTest::SetUp();
    presenter_.reset();
    const auto plans = std::make_shared<std::vector<HeadPlan>>(2, plain_head(kWidth, kHeight));
    for (HeadPlan& plan : *plans) plan.mask = warp::MaskImage(kWidth, kHeight, 0.999f);
    const AttractTimes times{std::chrono::milliseconds(100), std::chrono::milliseconds(200)};
    auto made = Presenter::make(output_.get(), plans, true, *frame_of(0, plain(32, 16, 0)), times, &mailbox_, &clock_);
    ASSERT_TRUE(made) << made.error().message();
    presenter_ = *std::move(made);
    mailbox_.frames.put(frame_of(1, plain(80, 40, 200)));
    refresh_for(std::chrono::milliseconds(400));
  }
  int code() { return shown().at(30, 20)[1]; }
};

TEST_F(HeadChangeTest, fades_for_half_a_second_without_a_jump_or_an_allocation) {
  // llvmpipe compiles a shader anew for textures of other sizes, at a first change as at a first frame.
  mailbox_.plans.wanted.put(heads_with_mask(0.998f));
  refresh_for(std::chrono::milliseconds(700));
  ASSERT_NE(mailbox_.plans.replaced.take(), nullptr);
  const int before = code();
  auto set = heads_with_mask(0.05f);
  set->latest_at = clock_.now() + std::chrono::hours(1);
  mailbox_.plans.wanted.put(std::move(set));
  allocations = 0;
  std::vector<int> codes{before};
  TimePoint first{};
  TimePoint last{};
  for (int n = 0; n < 80; ++n) {
    codes.push_back(code());
    if (codes.back() == codes[codes.size() - 2]) continue;
    if (first == TimePoint{}) first = clock_.now();
    last = clock_.now();
  }
  EXPECT_EQ(allocations, 0);
  for (std::size_t i = 1; i < codes.size(); ++i) {
    EXPECT_LE(codes[i], codes[i - 1]);
    EXPECT_GE(codes[i], codes[i - 1] - 9) << i;
  }
  EXPECT_NEAR(to_seconds(last - first), 0.45, 0.1);
  EXPECT_NE(mailbox_.plans.replaced.take(), nullptr);
  // The final picture equals that of a presenter that never had another plan.
  const RgbImage changed = shown();
  mailbox_.plans.wanted.put(heads_with_mask(0.05f));
  refresh_for(std::chrono::milliseconds(700));
  EXPECT_EQ(shown(), changed);
}

TEST_F(HeadChangeTest, waits_a_limited_time_for_a_frame_with_the_needed_parts) {
  const int before = code();
  auto set = heads_with_mask(0.05f);
  set->needs_frames_after = 1;
  set->latest_at = clock_.now() + std::chrono::seconds(5);
  mailbox_.plans.wanted.put(std::move(set));
  refresh_for(std::chrono::milliseconds(2000));
  EXPECT_EQ(code(), before);
  mailbox_.frames.put(frame_of(2, plain(80, 40, 200)));
  refresh_for(std::chrono::milliseconds(700));
  EXPECT_LT(code(), before - 100);
  mailbox_.plans.replaced.take();
  set = heads_with_mask(0.999f);
  set->needs_frames_after = 2;
  set->latest_at = clock_.now() + std::chrono::seconds(2);
  mailbox_.plans.wanted.put(std::move(set));
  refresh_for(std::chrono::milliseconds(2800));
  EXPECT_EQ(code(), before) << "no frame came";
}

/// No refresh changes the share by more than its part of the fade (whose maximum slope is 1.5 times the mean).
class AttractFadeTest : public PresenterTest {
 protected:
  double step() {
    const double share = refresh().attract_share;
    EXPECT_LE(std::abs(share - last_), 1.5 * 10.0 / 200.0 + 1e-9);
    last_ = share;
    return share;
  }
  int steps_until(const std::function<bool(double)>& done) {
    int steps = 0;
    while (steps < 200 && !done(step())) ++steps;
    return steps;
  }
  double last_ = 1.0;
};

TEST_F(AttractFadeTest, fades_to_the_attract_picture_without_new_frames_and_back_without_a_jump) {
  EXPECT_EQ(step(), 1.0);
  EXPECT_THAT(shown().data(), ::testing::Each(0));
  mailbox_.frames.put(frame_of(1, plain(40, 20, 200)));
  mailbox_.headings.put({0.0, 0});
  EXPECT_NEAR(steps_until([](double share) { return share == 0.0; }), 20, 2);
  EXPECT_EQ(steps_until([](double share) { return share > 0.0; }), 200);  // Nobody moves, so the picture is right.
  mailbox_.headings.put({0.05, 0});
  EXPECT_NEAR(steps_until([](double share) { return share > 0.0; }), 10, 2);
  EXPECT_NEAR(steps_until([](double share) { return share > 0.5; }), 10, 2);
  mailbox_.frames.put(frame_of(2, plain(40, 20, 200), 0.05));  // The farm returns half way through the fade.
  EXPECT_NEAR(steps_until([](double share) { return share == 0.0; }), 10, 3);
}

TEST_F(AttractFadeTest, begins_when_the_tour_is_lost_even_if_nobody_moves) {
  mailbox_.frames.put(frame_of(1, plain(40, 20, 200)));
  steps_until([](double share) { return share == 0.0; });
  mailbox_.is_failing = true;
  EXPECT_NEAR(steps_until([](double share) { return share == 1.0; }), 30, 3);
  EXPECT_THAT(shown().data(), ::testing::Each(0));
}

TEST_F(AttractFadeTest, does_not_jump_when_refreshes_are_late) {
  mailbox_.frames.put(frame_of(1, plain(40, 20, 200)));
  for (int n = 0; n < 10; ++n) {
    clock_.advance(std::chrono::seconds(5));
    const double share = refresh().attract_share;
    EXPECT_LE(std::abs(share - last_), 1.5 * 50.0 / 200.0 + 1e-9);
    last_ = share;
  }
  EXPECT_EQ(last_, 0.0);
}

}  // namespace
}  // namespace cyclorama::display
