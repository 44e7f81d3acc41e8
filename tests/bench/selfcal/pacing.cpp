// SPDX-License-Identifier: Apache-2.0
// A display that turns its picture sixty times a second, with and without a calibration on the same machine that
// requests what is shown: regularity of its refreshes, in alternation.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "appliance/display/display.h"
#include "common/base/give_way.h"
#include "common/wire/show.grpc.pb.h"
#include "tests/bench/selfcal/selfcal_benches.h"
#include "tests/data_sets/demo_room.h"
#include "tests/data_sets/jpeg_tiles.h"
#include "tests/doubles/fake_tour.h"

namespace cyclorama {
namespace {

constexpr double kRefresh_hz = 60.0;
constexpr Duration kStepEvery = std::chrono::milliseconds(500);

/// The calibrator's work in a step, without cameras: requests the shown pictures, and computes.
class Healing {
 public:
  Healing(const std::string& display, BumpedShow* show)
      : stub_(wire::ShownPictures::NewStub(*make_channel(display))), show_(*show), moment_(show->last_moment()) {}

  void step() {
    wire::ShownRequest request;
    const TimePoint now = clock_.now();
    request.set_from_ns(to_nanoseconds(now - std::chrono::milliseconds(60)));
    request.set_until_ns(to_nanoseconds(now));
    request.set_factor(2);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(2));
    wire::ShownReply reply;
    if (stub_->GetShown(&context, request, &reply).ok() && reply.moments_size() > 0) ++answers;
    moment_.now += kStepEvery;
    moment_.shown.clear();
    for (healing::ShownUntil& until : moment_.until) until.at += kStepEvery;
    for (healing::CameraPicture& seen : moment_.seen) {
      seen.opened += kStepEvery;
      seen.closed += kStepEvery;
    }
    show_.calibrator().step(moment_);
  }
  int answers = 0;

 private:
  SteadyClock clock_;
  std::unique_ptr<wire::ShownPictures::Stub> stub_;
  BumpedShow& show_;
  healing::ShowMoment moment_;
};

double p99_ms(std::vector<double> intervals) { return percentile(std::move(intervals), 0.99); }

}  // namespace

std::optional<Pacing> measure_pacing(const ShowContent& content, bool is_quick) {
  auto made = BumpedShow::make({}, content);
  if (!made) return std::nullopt;
  for (int i = 0; i < 14; ++i) {
    if (!made->step()) return std::nullopt;
  }
  const auto tour = FakeTour::start();
  display::DisplayOptions options;
  options.installation = demo_room();
  options.tour = tour->address();
  options.width_px = 2048;
  options.refresh_hz = kRefresh_hz;
  std::atomic<bool> is_on{false};
  std::array<std::vector<double>, 2> intervals_ms;
  std::optional<TimePoint> last;
  bool was_on = false;
  options.on_refresh = [&](const display::RefreshEvent& event) {
    const bool on = is_on;
    if (last && on == was_on) intervals_ms[on ? 1 : 0].push_back(to_milliseconds(event.presented.at - *last));
    last = event.presented.at;
    was_on = on;
  };
  const SteadyClock clock;
  auto display = display::Display::start(std::move(options), clock);
  if (!display) return std::nullopt;
  std::atomic<bool> is_over{false};
  std::thread serving([&] {
    while (!is_over) (*display)->serve(clock.now() + std::chrono::milliseconds(20));
  });
  const bool is_there = tour->wait_for_display();
  if (is_there) {
    const auto wanted = from_wire(tour->hello.wanted());
    if (wanted) {
      const RgbImage picture(width_px(wanted->shape), height_px(wanted->shape), 90);
      tour->send_all(frame_messages(1, picture, wanted->shape, 0.0, 256));
    }
  }
  Healing healing("[::1]:" + std::to_string((*display)->port()), &*made);
  std::thread working([&] {
    give_way(10);
    for (TimePoint next = clock.now(); !is_over; next += kStepEvery) {
      clock.wait_until(next);
      if (is_on) healing.step();
    }
  });
  const int rounds = is_quick ? 2 : 6;
  for (int i = 0; is_there && i < 2 * rounds; ++i) {
    is_on = i % 2 == 1;
    const TimePoint until = clock.now() + std::chrono::seconds(5);
    for (int k = 0; clock.now() < until; ++k) {
      tour->send_heading(0.02 * std::sin(0.05 * k), k + 1);
      clock.wait_until(clock.now() + std::chrono::milliseconds(16));
    }
  }
  is_over = true;
  working.join();
  serving.join();
  const auto late = [](const std::vector<double>& all) {
    return static_cast<double>(std::ranges::count_if(all, [](double ms) { return ms > 1.5e3 / kRefresh_hz; })) /
           std::max<double>(1.0, static_cast<double>(all.size()));
  };
  if (!is_there || healing.answers == 0) return std::nullopt;
  return Pacing{p99_ms(intervals_ms[0]), p99_ms(intervals_ms[1]), late(intervals_ms[0]), late(intervals_ms[1])};
}

}  // namespace cyclorama
