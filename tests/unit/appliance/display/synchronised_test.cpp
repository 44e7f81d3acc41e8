// SPDX-License-Identifier: Apache-2.0
// Several displays of one tour, simulated in true time: clocks that are wrong and drift, outputs that run freely at
// their own rates, a network with delays that differ by direction. The deciding parts are real: the tour's schedule and
// each display's clock and numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <random>
#include <vector>

#include "appliance/display/synchronised_refresh.h"
#include "appliance/display/synchronised_share.h"
#include "appliance/display/tour_clock.h"
#include "kiosk/tour/session/show_schedule.h"

namespace cyclorama::display {
namespace {

using namespace std::chrono_literals;

/// Events in order of true time.
class Events {
 public:
  void at(TimePoint when, std::function<void()> what) { queue_.push({when, ++order_, std::move(what)}); }
  void run_until(TimePoint end) {
    while (!queue_.empty() && queue_.top().when < end) {
      const Event event = queue_.top();
      queue_.pop();
      now_ = event.when;
      event.what();
    }
  }
  [[nodiscard]] TimePoint now() const { return now_; }

 private:
  struct Event {
    TimePoint when;
    std::uint64_t order;
    std::function<void()> what;
    bool operator<(const Event& other) const { return when != other.when ? when > other.when : order > other.order; }
  };
  std::priority_queue<Event> queue_;
  std::uint64_t order_ = 0;
  TimePoint now_{};
};

/// Differences of one computer from the others.
struct Computer {
  Duration skew{};  ///< Error of its clock.
  double drift_ppm = 0.0;
  double refresh_hz = 60.0;  ///< True rate.
  Duration phase{};
  Duration there{};  ///< Minimum delay of a message to the tour.
  Duration back{};   ///< Minimum delay from the tour.
  Duration decode = 8ms;
};

class Room {
 public:
  explicit Room(const std::vector<Computer>& computers, unsigned seed = 1)
      : random_(seed), displays_(computers.size()) {
    for (std::size_t i = 0; i < computers.size(); ++i) {
      displays_[i].computer = computers[i];
      wire::DisplayHello hello;
      hello.set_refresh_hz(60.0);  // Nominal rate of the mode; the crystal differs.
      schedule_.joined(i, hello);
      events_.at(kBegin + computers[i].phase, [this, i] { begin_drawing(i); });
    }
    events_.at(kBegin, [this] { end_frame(); });
  }

  /// One line per display and refresh.
  struct Shown {
    TimePoint at{};  ///< True time.
    std::int64_t number = 0;
    std::int64_t frame = 0;
  };
  void run(Duration time) { events_.run_until(kBegin + time); }
  [[nodiscard]] const std::vector<Shown>& shown(std::size_t display) const { return displays_[display].shown; }

  struct Agreement {
    std::int64_t refreshes = 0;
    std::int64_t agreeing = 0;
    std::int64_t max_difference = 0;       ///< Maximum difference in frames at one number.
    std::int64_t max_difference_ever = 0;  ///< Maximum difference in frames at any time.
  };
  /// Evaluated once `warm_up` has passed.
  [[nodiscard]] Agreement agreement(Duration warm_up) const {
    Agreement result;
    std::vector<std::map<std::int64_t, std::int64_t>> by_number(displays_.size());
    std::vector<std::pair<TimePoint, std::size_t>> changes;
    std::int64_t first = 0;
    std::int64_t last = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = 0; i < displays_.size(); ++i) {
      for (const Shown& shown : displays_[i].shown) {
        if (shown.at >= kBegin + warm_up) by_number[i][shown.number] = shown.frame;
      }
      first = std::max(first, by_number[i].begin()->first);
      last = std::min(last, by_number[i].rbegin()->first);
    }
    for (std::int64_t number = first; number <= last; ++number) {
      std::vector<std::int64_t> frames;
      // A number that was skipped shows the former picture.
      for (const auto& numbers : by_number) frames.push_back(std::prev(numbers.upper_bound(number))->second);
      const auto [min, max] = std::ranges::minmax(frames);
      ++result.refreshes;
      result.agreeing += min == max ? 1 : 0;
      result.max_difference = std::max(result.max_difference, max - min);
    }
    for (const Display& display : displays_) {
      for (const Shown& shown : display.shown) {
        if (shown.at < kBegin + warm_up) continue;
        for (const Display& other : displays_) {
          const auto after = std::ranges::upper_bound(other.shown, shown.at, {}, &Shown::at);
          if (after == other.shown.begin()) continue;
          result.max_difference_ever =
              std::max(result.max_difference_ever, std::abs(std::prev(after)->frame - shown.frame));
        }
      }
    }
    return result;
  }
  [[nodiscard]] std::optional<double> synchronised_share(std::size_t display) const {
    return displays_[display].share.share(clock_of(display, events_.now()));
  }

  /// Simulates a hiccup: nothing arrives at display `i` before then.
  void hold(std::size_t i, Duration until) { displays_[i].held_until = kBegin + until; }

 private:
  struct Display {
    Computer computer;
    SynchronisedRefresh shared;
    TourClock clock{[] { return SystemTime{}; }};
    std::uint64_t refreshes = 0;
    std::vector<std::pair<std::int64_t, ShowAt>> waiting;
    std::int64_t frame = 0;
    ShowAt due;
    std::vector<Shown> shown;
    SynchronisedShare share;
    TimePoint held_until{};
    TimePoint ready_at{};
  };

  [[nodiscard]] TimePoint clock_of(std::size_t i, TimePoint t) const {
    const Computer& computer = displays_[i].computer;
    const double drift_s = 1e-6 * computer.drift_ppm * to_seconds(t - kBegin);
    return t + computer.skew + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(drift_s));
  }
  Duration delay(Duration min) {
    return min +
           std::chrono::microseconds(static_cast<int>(std::exponential_distribution<double>(1.0 / 150.0)(random_)));
  }

  void end_frame() {
    const TimePoint now = events_.now();
    const std::int64_t frame = ++newest_frame_;
    const auto said = schedule_.frame_at(now + kTourAhead);
    ASSERT_TRUE(said);
    wire::ShowMessage message;
    *message.mutable_show_at() = *said;
    for (std::size_t i = 0; i < displays_.size(); ++i) {
      const Computer& computer = displays_[i].computer;
      const auto decode = computer.decode * std::uniform_real_distribution<double>(1.0, 1.5)(random_);
      // Decoded one after the other, in order of arrival.
      TimePoint& ready = displays_[i].ready_at;
      ready = std::max(ready, std::max(now + delay(computer.back), displays_[i].held_until) +
                                  std::chrono::duration_cast<Duration>(decode));
      events_.at(ready, [this, i, frame, at = show_at_of(message)] {
        displays_[i].clock.frame_ready(at, clock_of(i, events_.now()));
        displays_[i].waiting.emplace_back(frame, at);
      });
    }
    events_.at(now + std::chrono::microseconds(std::uniform_int_distribution<int>(35'000, 65'000)(random_)),
               [this] { end_frame(); });
  }

  void begin_drawing(std::size_t i) {
    Display& display = displays_[i];
    const TimePoint now = events_.now();
    const TimePoint local = clock_of(i, now);
    ask(i);
    display.shared.set_clock(display.clock.reading(local));
    for (const auto& [frame, at] : display.waiting) display.shared.learn(at);
    display.shared.begin(local);
    display.due = {};
    for (const auto& [frame, at] : display.waiting) {
      if (frame <= display.frame || !display.shared.is_due(at)) continue;
      display.frame = frame;
      // Same as in the presenter: the frame was overdue from its refresh on, whichever frame is visible now.
      if (display.due.period_ns == 0 || at.refresh < display.due.refresh) display.due = at;
    }
    std::erase_if(display.waiting, [&](const auto& waiting) { return waiting.first <= display.frame; });
    const auto draw = std::chrono::microseconds(std::uniform_int_distribution<int>(1'000, 3'000)(random_));
    const TimePoint vblank = kBegin + display.computer.phase + kDrawTime +
                             std::chrono::duration_cast<Duration>(std::chrono::duration<double>(
                                 static_cast<double>(display.refreshes) / display.computer.refresh_hz));
    // Headless outputs report the time when the picture was complete, which is some time after the refresh.
    events_.at(vblank, [this, i, draw] { show(i, draw); });
    ++display.refreshes;
    events_.at(
        vblank - kDrawTime +
            std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / display.computer.refresh_hz)),
        [this, i] { begin_drawing(i); });
  }

  void show(std::size_t i, Duration late) {
    Display& display = displays_[i];
    const std::optional<std::int64_t> before = display.shared.number();
    const TimePoint local = clock_of(i, events_.now());
    display.shared.shown({display.refreshes, local + late}, 60.0);
    const std::optional<std::int64_t> number = display.shared.number();
    if (!number) return;
    display.clock.drawn_ahead(display.shared.drawn_ahead());
    const std::int64_t missing =
        display.due.period_ns == 0 ? 0 : std::max<std::int64_t>(0, *number - display.due.refresh);
    if (before) display.share.add(local, std::max<std::int64_t>(0, *number - *before), missing);
    display.shown.push_back({events_.now(), *number, display.frame});
  }

  void ask(std::size_t i) {
    const auto question = displays_[i].clock.question(clock_of(i, events_.now()));
    if (!question) return;
    events_.at(events_.now() + delay(displays_[i].computer.there), [this, i, question = *question] {
      const TimePoint tour_now = events_.now() + kTourAhead;
      schedule_.measured(question, tour_now);
      wire::ClockReply answer;
      answer.set_asked_ns(question.asked_ns());
      answer.set_received_ns(to_nanoseconds(tour_now));
      answer.set_answered_ns(to_nanoseconds(tour_now));
      events_.at(std::max(events_.now() + delay(displays_[i].computer.back), displays_[i].held_until),
                 [this, i, answer] { displays_[i].clock.take(answer, clock_of(i, events_.now())); });
    });
  }

  static constexpr TimePoint kBegin{10h};
  static constexpr Duration kTourAhead = -9h;
  static constexpr Duration kDrawTime = 5ms;
  std::mt19937 random_;
  Events events_;
  tour::ShowSchedule schedule_;
  std::vector<Display> displays_;
  std::int64_t newest_frame_ = 0;
};

void expect_synchronised(const Room::Agreement& agreement) {
  EXPECT_GT(agreement.refreshes, 5000);
  EXPECT_GE(static_cast<double>(agreement.agreeing), 0.999 * static_cast<double>(agreement.refreshes))
      << agreement.refreshes - agreement.agreeing << " of " << agreement.refreshes << " differ";
  EXPECT_LE(agreement.max_difference, 1);
  EXPECT_LE(agreement.max_difference_ever, 1);
}

TEST(Synchronised, displays_with_skewed_and_drifting_clocks_show_the_same_frames) {
  Room room({{-3h, 80.0, 60.0, 0ms}, {17ms, -60.0, 60.0, 5ms}, {400s, 20.0, 60.0, 11ms}, {0s, 0.0, 60.0, 16ms}});
  room.run(10min);
  expect_synchronised(room.agreement(5s));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_GE(*room.synchronised_share(i), 0.999) << i;
}

TEST(Synchronised, free_running_outputs_pass_through_every_phase) {
  Room room({{1s, 0.0, 60.0, 0ms}, {2s, 0.0, 59.99, 3ms}, {3s, 0.0, 60.006, 9ms}});
  room.run(10min);
  expect_synchronised(room.agreement(5s));
}

TEST(Synchronised, asymmetric_networks_cost_no_more_than_their_asymmetry) {
  Room room(
      {{1s, 0.0, 60.0, 2ms, 200us, 200us}, {2s, 0.0, 60.0, 2ms, 200us, 1800us}, {3s, 0.0, 60.0, 2ms, 2200us, 100us}});
  room.run(5min);
  expect_synchronised(room.agreement(5s));
}

TEST(Synchronised, random_farms_of_displays_stay_synchronised) {
  for (unsigned seed = 2; seed < 8; ++seed) {
    std::mt19937 random(seed);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
    std::vector<Computer> computers;
    for (int i = 0; i < 3; ++i) {
      const auto ms = [&](double a, double b) {
        return std::chrono::microseconds(static_cast<int>(1e3 * between(a, b)));
      };
      computers.push_back({ms(-1e5, 1e5), between(-90, 90), between(59.995, 60.005), ms(0, 16.6), ms(0.1, 0.8),
                           ms(0.1, 0.8), ms(2, 25)});
    }
    Room room(computers, seed);
    room.run(2min);
    expect_synchronised(room.agreement(5s));
  }
}

TEST(Synchronised, a_display_that_is_too_slow_delays_no_other_and_reports_it) {
  Room room({{0s, 0.0, 60.0, 0ms}, {0s, 0.0, 60.0, 5ms}, {0s, 0.0, 60.0, 8ms, {}, {}, 300ms}});
  room.run(2min);
  EXPECT_GE(*room.synchronised_share(0), 0.999);
  EXPECT_GE(*room.synchronised_share(1), 0.999);
  EXPECT_LT(*room.synchronised_share(2), 0.5);
  EXPECT_GT(room.shown(2).back().frame, 1000) << "late, but it shows them";
  const auto first = room.shown(0).back().frame;
  EXPECT_LE(first - room.shown(2).back().frame, 12);
}

TEST(Synchronised, a_hiccup_affects_one_display_which_is_synchronised_at_the_next_frame) {
  Room room({{0s, 0.0, 60.0, 0ms}, {5s, 0.0, 60.0, 5ms}});
  room.run(60s);
  room.hold(1, 60s + 200ms);
  room.run(61s);
  EXPECT_LT(*room.synchronised_share(1), 0.999);
  EXPECT_EQ(*room.synchronised_share(0), 1.0);
  room.run(62s);
  room.hold(1, 62s + 110ms);
  room.run(122s);
  EXPECT_EQ(*room.synchronised_share(1), 1.0)
      << "the next within a minute finds the tour prepared, and costs no refresh";
}

TEST(SynchronisedShare, covers_the_last_minute) {
  SynchronisedShare share;
  const TimePoint begin(1000s);
  EXPECT_FALSE(share.share(begin));
  share.add(begin, 60, 3);
  EXPECT_NEAR(*share.share(begin), 0.95, 1e-12);
  share.add(begin + 30s, 60, 0);
  EXPECT_NEAR(*share.share(begin + 59s), 0.975, 1e-12);
  EXPECT_EQ(*share.share(begin + 60s), 1.0) << "the first is forgotten";
  EXPECT_FALSE(share.share(begin + 95s));
  share.add(begin + 100s, 2, 900);
  EXPECT_EQ(*share.share(begin + 100s), 0.0);
}

}  // namespace
}  // namespace cyclorama::display
