// SPDX-License-Identifier: Apache-2.0
// Lets the calls of a graphics card take as long as cables and projectors make them take, in simulated time: 50 ms for
// a probe (DDC), 3 s for a modeset. Counts the refreshes that the other heads miss meanwhile. Exits with 1 if there are
// any.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "drivers/output/drm/drm_output.h"
#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama {
namespace {

constexpr auto kProbeTime = std::chrono::milliseconds(50);
constexpr auto kModesetTime = std::chrono::seconds(3);
constexpr auto kShowTime = std::chrono::seconds(30);

struct Tally {
  std::string event;
  int calls = 0;   ///< Probes and modesets that took their time.
  int missed = 0;  ///< Refreshes that heads missed which the event does not concern.
  bool is_well = true;
};

FakeCard slow_card() {
  FakeCard card = three_projectors();
  for (FakeConnector& connector : card.connectors) connector.probe_time = kProbeTime;
  return card;
}

/// A show on fake cards, and an event in it.
class Show {
 public:
  explicit Show(std::vector<FakeCard> cards) : machine_(std::move(cards), &clock_) {
    options_.make_probe_runner = [this] { return machine_.probe_runner(); };
  }

  [[nodiscard]] FakeMachine& machine() { return machine_; }
  void add_head(const std::string& connector) { options_.heads.push_back({{connector, 64, 36}, connector}); }

  /// Shows for a time, with the event after its first second.
  Status run(const std::function<void()>& event) {
    TRY_ASSIGN(output_, output::open_drm_output(options_, clock_));
    TRY(show_until(clock_.now() + std::chrono::seconds(1)));
    begun_at_ = clock_.now();
    const int before = calls();
    event();
    TRY(show_until(begun_at_ + kShowTime));
    calls_ = calls() - before;
    return Done{};
  }

  [[nodiscard]] int slow_calls() const { return calls_; }
  /// Returns how many refreshes a head missed during the event.
  [[nodiscard]] int missed(std::size_t card, std::size_t number, double refresh_hz) const {
    int missed = 0;
    TimePoint last = begun_at_;
    for (const TimePoint at : machine_.shown_at(card, number)) {
      if (at <= begun_at_) continue;
      missed += std::max(0, static_cast<int>(std::lround(to_seconds(at - last) * refresh_hz)) - 1);
      last = at;
    }
    return missed + std::max(0, static_cast<int>(std::lround(to_seconds(clock_.now() - last) * refresh_hz)) - 1);
  }

 private:
  Status show_until(TimePoint end) {
    while (clock_.now() < end) {
      TRY(output_->wait_for_refresh());
      for (std::size_t head = 0; head < options_.heads.size(); ++head) {
        TRY(output_->draw_to(head));
        output_->gl().Clear(GL_COLOR_BUFFER_BIT);
      }
      TRY(output_->present());
    }
    return Done{};
  }
  [[nodiscard]] int calls() const {
    int count = 0;
    for (const char* const call : {"drmModeGetConnector", "drmModeAtomicCommit (modeset)"}) {
      const auto found = machine_.calls().find(call);
      if (found != machine_.calls().end()) count += found->second;
    }
    return count;
  }

  FakeClock clock_;
  FakeMachine machine_;
  output::DrmOptions options_;
  std::unique_ptr<output::Output> output_;
  TimePoint begun_at_{};
  int calls_ = 0;
};

/// Runs a show of three heads on one card, or with a fourth on a second card; `changing` is the head of the event.
Tally run(const std::string& text, std::vector<FakeCard> cards, std::size_t changing,
          const std::function<void(FakeMachine*)>& event) {
  const bool has_second = cards.size() > 1;
  Show show(std::move(cards));
  for (const char* const connector : {"0:HDMI-A-1", "0:HDMI-A-2", "0:HDMI-A-3"}) show.add_head(connector);
  if (has_second) show.add_head("1:HDMI-A-1");
  const auto shown = show.run([&] { event(&show.machine()); });
  Tally tally{text, show.slow_calls(), 0, shown.has_value()};
  for (std::size_t head = 0; head < (has_second ? 4U : 3U); ++head) {
    const std::size_t card = head / 3;
    const auto mode = show.machine().mode_of(card, head % 3);
    if (head == changing || !mode) continue;
    tally.missed += show.missed(card, head % 3, mode->vrefresh);
  }
  return tally;
}

FakeCard with_dark(std::size_t number) {
  FakeCard card = slow_card();
  card.connectors[number].is_connected = false;
  card.connectors[number].modeset_time = kModesetTime;
  return card;
}

FakeCard second_card(FakeCard card) {
  card.path = "/dev/dri/card1";
  return card;
}

std::vector<Tally> run_all() {
  const auto nothing = [](FakeMachine*) {};
  const auto plug = [](std::size_t card, std::size_t number, bool is_connected) {
    return [=](FakeMachine* machine) {
      machine->connector(card, number).is_connected = is_connected;
      machine->hot_plug();
    };
  };
  FakeCard slower = slow_card();
  slower.connectors[1].modes = {fake_mode(64, 36, 50.0, true)};
  std::vector<Tally> tallies;
  tallies.push_back(run("one head stays dark", {with_dark(1)}, 1, nothing));
  tallies.push_back(run("a projector is switched on", {with_dark(1)}, 1, plug(0, 1, true)));
  tallies.push_back(run("a projector is switched off", {slow_card()}, 1, plug(0, 1, false)));
  tallies.push_back(run("an event that changes nothing", {slow_card()}, 3, [](FakeMachine* m) { m->hot_plug(); }));
  tallies.push_back(run("a projector on a second card is switched on", {slow_card(), second_card(with_dark(0))}, 3,
                        plug(1, 0, true)));
  tallies.push_back(run("a head of 50 Hz beside heads of 60 Hz", {slower}, 3, nothing));
  return tallies;
}

}  // namespace
}  // namespace cyclorama

int main() {
  int calls = 0;
  int missed = 0;
  bool is_well = true;
  fmt::print("{:<48} {:>10} {:>26}\n", "in 30 s of a show", "slow calls", "refreshes that others miss");
  for (const cyclorama::Tally& tally : cyclorama::run_all()) {
    fmt::print("{:<48} {:>10} {:>26}{}\n", tally.event, tally.calls, tally.missed, tally.is_well ? "" : "  LOST");
    calls += tally.calls;
    missed += tally.missed;
    is_well = is_well && tally.is_well;
  }
  fmt::print("{{\"benchmark\": \"display-slow-card\", \"calls\": {}, \"missed_refreshes\": {}}}\n", calls, missed);
  return is_well && missed == 0 ? 0 : 1;
}
