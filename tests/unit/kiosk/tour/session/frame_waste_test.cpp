// SPDX-License-Identifier: Apache-2.0
/// Counts the frames that are rendered for nothing, with a simulated farm and display: no thread, no clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "kiosk/tour/session/show_meter.h"
#include "kiosk/tour/session/view_pacer.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;

struct Range {
  Duration min{};
  Duration max{};
};

/// The farm renders one frame at a time. The display shows the newest frame that is decoded when a
/// refresh begins, and reports each frame.
struct Show {
  Duration told_refresh = 50ms;  ///< Stated in the display's hello.
  Range refresh{50ms, 50ms};
  Range render{30ms, 40ms};
  Duration network = 5ms;
  Duration decode = 6ms;
  bool is_paced = true;  ///< False: the tour requests a view whenever the farm has room.
};

struct Counts {
  int shown = 0;
  int wasted = 0;
  int requested = 0;
  [[nodiscard]] double wasted_share() const { return static_cast<double>(wasted) / std::max(1, shown + wasted); }
};

class Simulation {
 public:
  explicit Simulation(const Show& show) : show_(show) {
    meter_.joined(1, show.told_refresh);
    if (show.is_paced) pacer_.set_refresh_period(meter_.refresh_period());
  }
  /// Walks on for `how_long`.
  Counts run(Duration how_long) {
    counts_ = {};
    for (const TimePoint end = now_ + how_long; now_ < end; now_ += 500us) {
      render();
      refresh();
      report();
      request();
    }
    return counts_;
  }
  void stall_display(Duration how_long) { next_refresh_ = now_ + how_long; }

 private:
  struct Event {
    std::uint64_t number = 0;
    TimePoint at{};
    bool is_shown = false;
  };
  Duration any(const Range& range) {
    return range.min + std::chrono::duration_cast<Duration>(std::uniform_real_distribution<double>()(random_) *
                                                            std::chrono::duration<double>(range.max - range.min));
  }
  void request() {
    wire::View view;
    view.set_number(number_ + 1);
    view.set_heading_rad(1e-3 * static_cast<double>(number_ + 1));
    const bool is_late = show_.is_paced && meter_.are_displays_late(now_);
    if (is_late || !pacer_.wants(view, now_)) return;
    ++number_;
    ++counts_.requested;
    pacer_.asked(view, now_);
    meter_.asked(number_, now_);
    at_farm_.push_back({number_, now_ + show_.network});
  }
  void render() {
    if (rendering_ && now_ >= rendering_->at) {
      pacer_.ended(rendering_->number);
      meter_.ended(rendering_->number, now_);
      decoded_.push_back({rendering_->number, now_ + show_.decode});
      rendering_.reset();
    }
    if (rendering_ || at_farm_.empty() || now_ < at_farm_.front().at) return;
    rendering_ = Event{at_farm_.front().number, now_ + any(show_.render) + show_.network};
    at_farm_.pop_front();
  }
  void refresh() {
    if (now_ < next_refresh_) return;
    next_refresh_ = now_ + any(show_.refresh);
    std::deque<Event> ready;
    while (!decoded_.empty() && decoded_.front().at <= now_) {
      ready.push_back(decoded_.front());
      decoded_.pop_front();
    }
    for (const Event& frame : ready) {
      const bool is_shown = frame.number == ready.back().number;
      (is_shown ? counts_.shown : counts_.wasted) += 1;
      reports_.push_back({frame.number, now_ + show_.told_refresh / 4, is_shown});
    }
  }
  void report() {
    while (!reports_.empty() && reports_.front().at <= now_) {
      const Event told = reports_.front();
      reports_.pop_front();
      if (told.is_shown && meter_.presented(1, told.number, 5ms, now_)) pacer_.shown();
      if (told.is_shown) continue;
      if (const auto next_after = meter_.not_shown(1, told.number)) pacer_.not_shown(*next_after);
    }
  }

  const Show show_;
  std::mt19937 random_{3};
  ViewPacer pacer_{true};
  ShowMeter meter_;
  TimePoint now_{100s};
  TimePoint next_refresh_ = now_;
  std::uint64_t number_ = 0;
  std::deque<Event> at_farm_;
  std::optional<Event> rendering_;
  std::deque<Event> decoded_;
  std::deque<Event> reports_;
  Counts counts_;
};

Counts settled(const Show& show) {
  Simulation simulation(show);
  simulation.run(20s);
  return simulation.run(60s);
}

TEST(FrameWaste, is_large_if_views_are_requested_whenever_the_farm_has_room) {
  Show show;
  show.is_paced = false;
  EXPECT_GT(settled(show).wasted_share(), 0.15) << "28 frames a second for 20 refreshes";
  show.refresh = {80ms, 85ms};
  EXPECT_GT(settled(show).wasted_share(), 0.45) << "28 frames a second for 12 refreshes: what the demo showed";
}

TEST(FrameWaste, is_below_two_percent_whatever_the_rates_of_farm_and_display) {
  struct Case {
    const char* name;
    Show show;
    double min_shown_hz;
  };
  const Show usual;
  std::vector<Case> cases(8, {"a farm a little faster than the display", usual, 17.0});
  cases[1].name = "a farm much faster than the display";
  cases[1].show.render = {15ms, 25ms};
  cases[2].name = "an uneven farm, as fast as the display";
  cases[2].show.render = {30ms, 70ms};
  cases[2].min_shown_hz = 12.0;
  cases[3].name = "a display that is slower than it says";
  cases[3].show.refresh = {80ms, 85ms};
  cases[3].min_shown_hz = 11.0;
  cases[4].name = "an uneven display";
  cases[4].show.refresh = {50ms, 120ms};
  cases[4].min_shown_hz = 8.0;
  cases[5].name = "a farm slower than the display";
  cases[5].show.told_refresh = 16667us;
  cases[5].show.refresh = {16667us, 16667us};
  cases[5].show.render = {70ms, 130ms};
  cases[5].min_shown_hz = 9.0;
  cases[6].name = "a farm far away";
  cases[6].show.network = 50ms;
  cases[6].min_shown_hz = 11.0;
  cases[7] = cases[5];
  cases[7].name = "sixty a second";
  cases[7].show.render = {5ms, 8ms};
  cases[7].min_shown_hz = 54.0;
  for (const Case& one : cases) {
    const Counts counts = settled(one.show);
    EXPECT_LT(counts.wasted_share(), 0.02) << one.name;
    EXPECT_GT(counts.shown / 60.0, one.min_shown_hz) << one.name;
  }
}

TEST(FrameWaste, is_small_from_the_first_seconds_on) {
  EXPECT_LT(Simulation(Show{}).run(5s).wasted_share(), 0.02);
  Show slow;
  slow.refresh = {80ms, 85ms};
  EXPECT_LE(Simulation(slow).run(5s).wasted, 5);
}

TEST(FrameWaste, ends_while_a_display_stands_still_and_goes_on_with_it) {
  Simulation simulation(Show{});
  simulation.run(20s);
  simulation.stall_display(800ms);
  const Counts stalled = simulation.run(800ms);
  EXPECT_LE(stalled.requested, 5) << "those that were due before the display was late";
  EXPECT_GT(simulation.run(5s).shown, 60);
}

TEST(FrameWaste, a_display_that_reports_nothing_any_more_is_not_waited_for) {
  Simulation simulation(Show{});
  simulation.run(20s);
  simulation.stall_display(60s);
  EXPECT_GT(simulation.run(30s).requested, 200);
}

}  // namespace
}  // namespace cyclorama::tour
