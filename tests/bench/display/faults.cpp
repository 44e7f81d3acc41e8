// SPDX-License-Identifier: Apache-2.0
// Makes every call of libdrm, GBM, EGL and udev in the DRM output fail once, in each possible way, when the show starts
// and during the show. Prints what the wall shows and the time to recovery. Exits with 1 if it does not recover.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "drivers/output/drm/drm_output.h"
#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama {
namespace {

constexpr std::size_t kHeads = 4;  // Three on the card that renders, one on another.
constexpr int kMaxRefreshes = 30;

struct Way {
  int error;
  const char* name;
};
constexpr std::array<Way, 6> kWays{
    {{EBUSY, "EBUSY"}, {EACCES, "EACCES"}, {ENODEV, "ENODEV"}, {EINVAL, "EINVAL"}, {EIO, "EIO"}, {ENOMEM, "ENOMEM"}}};

/// State of the wall at one refresh, worst first.
enum class Seen { kDark, kOld, kOtherMode, kWell };

/// The output's user; like the display's own, but it retries at once.
class Show {
 public:
  Show() : machine_(cards(), &clock_) {
    for (std::size_t i = 0; i < kHeads; ++i)
      options_.heads.push_back(
          {{fmt::format("head {}", i), 64, 36}, i < 3 ? fmt::format("0:HDMI-A-{}", i + 1) : "1:HDMI-A-1"});
    options_.flip_timeout = std::chrono::milliseconds(3);
    options_.make_probe_runner = [this] { return machine_.probe_runner(); };
  }

  [[nodiscard]] FakeMachine& machine() { return machine_; }

  Seen refresh() {
    ++colour_;
    if (output_ == nullptr) {
      auto opened = output::open_drm_output(options_, clock_);
      if (opened) output_ = *std::move(opened);
    }
    if (output_ == nullptr) {
      clock_.advance(std::chrono::microseconds(16'667));
    } else if (auto drawn = draw(); !drawn) {
      output_.reset();
      ++losses_;
    }
    return look();
  }
  [[nodiscard]] int losses() const { return losses_; }

 private:
  static std::vector<FakeCard> cards() {
    FakeCard second = three_projectors();
    second.path = "/dev/dri/card1";
    std::vector<FakeCard> cards{three_projectors(), second};
    for (FakeCard& card : cards) {
      for (FakeConnector& connector : card.connectors) connector.modes.push_back(fake_mode(48, 27, 60.0));
    }
    return cards;
  }
  Status draw() {
    TRY(output_->wait_for_refresh());
    const output::Gl& gl = output_->gl();
    for (std::size_t head = 0; head < kHeads; ++head) {
      TRY(output_->draw_to(head));
      gl.ClearColor(static_cast<float>(colour_ % 256) / 255.0f, static_cast<float>(head) / 255.0f, 0.0f, 1.0f);
      gl.Clear(GL_COLOR_BUFFER_BIT);
    }
    TRY(output_->present());
    return Done{};
  }
  [[nodiscard]] Seen look() {
    if (output_ == nullptr) return Seen::kDark;
    Seen worst = Seen::kWell;
    for (std::size_t head = 0; head < kHeads; ++head) {
      if (!machine_.connector(head / 3, head % 3).is_connected) continue;  // A disconnected head is invisible.
      const auto wall = machine_.wall(head / 3, head % 3);
      if (!wall) return Seen::kDark;
      const std::uint8_t* const p = wall->at(wall->width() / 2, wall->height() / 2);
      const Seen seen = p[0] != colour_ % 256 || p[1] != head ? Seen::kOld
                        : wall->width() != 64                 ? Seen::kOtherMode
                                                              : Seen::kWell;
      worst = std::min(worst, seen);
    }
    return worst;
  }

  FakeClock clock_;
  FakeMachine machine_;
  output::DrmOptions options_;
  std::unique_ptr<output::Output> output_;
  int colour_ = 0;
  int losses_ = 0;
};

struct Outcome {
  bool was_met = false;
  bool is_well = false;
  int refreshes = 0;  ///< From the fault until all heads show the newest picture.
  int dark = 0;
  int old = 0;
  bool is_other_mode = false;
  bool was_made_anew = false;
};

/// Provokes all calls that the output can make; `step` selects the next provocation.
void provoke(FakeMachine* machine, int step) {
  FakeConnector& swapped = machine->connector(0, 1);
  switch (step) {
    case 2:
      swapped.is_connected = false;
      machine->connector(1, 0).is_connected = false;
      return machine->hot_plug();
    case 4:
      swapped.is_connected = true;
      swapped.edid = fake_edid("another", 8);
      machine->connector(1, 0).is_connected = true;
      return machine->hot_plug();
    case 6:
      return machine->set_master_taken(0, true);
    case 7:
      return machine->set_master_taken(0, false);
    case 16:
      return machine->reset_gpu();
    default:
      return;
  }
}

Outcome run(const std::string& call, int error, bool is_start) {
  Show show;
  if (!is_start) {
    for (int n = 0; n < 5; ++n) show.refresh();
  }
  // A call that is not made while opening a card that no other process holds.
  const bool is_taken_first = is_start && call == "drmSetMaster";
  if (is_taken_first) show.machine().set_master_taken(0, true);
  show.machine().fail(call, error);
  const int losses = show.losses();
  Outcome outcome;
  int since = -1;
  for (int step = 0; step < 20 + kMaxRefreshes; ++step) {
    if (is_taken_first && step == 1) show.machine().set_master_taken(0, false);
    if (!is_start && !outcome.was_met) provoke(&show.machine(), step);
    const Seen seen = show.refresh();
    if (!outcome.was_met && show.machine().was_fault_met()) {
      outcome.was_met = true;
      // Ends the provocations, so that only the fault is left to recover from.
      show.machine().set_master_taken(0, false);
      for (const auto& [card, number] : {std::pair(0, 1), std::pair(1, 0)}) {
        FakeConnector& back =
            show.machine().connector(static_cast<std::size_t>(card), static_cast<std::size_t>(number));
        if (!back.is_connected) {
          back.is_connected = true;
          show.machine().hot_plug();
        }
      }
    }
    if (!outcome.was_met) continue;
    ++since;
    outcome.dark += seen == Seen::kDark ? 1 : 0;
    outcome.old += seen == Seen::kOld ? 1 : 0;
    outcome.is_other_mode |= seen == Seen::kOtherMode;
    if (seen < Seen::kOtherMode) continue;
    outcome.is_well = true;
    outcome.refreshes = since;
    break;
  }
  outcome.was_made_anew = show.losses() > losses;
  outcome.is_well = outcome.is_well && outcome.refreshes <= kMaxRefreshes;
  return outcome;
}

std::string text_of(const Outcome& outcome) {
  if (!outcome.was_met) return "NEVER CALLED";
  if (!outcome.is_well) return "NOT WELL AGAIN";
  std::string text;
  if (outcome.dark > 0) text += fmt::format("dark for {}, ", outcome.dark);
  if (outcome.old > 0) text += fmt::format("the last picture for {}, ", outcome.old);
  if (outcome.is_other_mode) text += "a head in its second best mode, ";
  if (outcome.was_made_anew) text += "all opened anew, ";
  if (text.empty()) return "the newest picture, always";
  return text + fmt::format("well after {}", outcome.refreshes);
}

/// Returns the names of the calls in a first show, in alphabetical order.
std::vector<std::string> all_calls() {
  Show show;
  for (int step = 0; step < 30; ++step) {
    provoke(&show.machine(), step);
    show.refresh();
  }
  std::vector<std::string> calls;
  for (const auto& [call, count] : show.machine().calls()) calls.push_back(call);
  return calls;
}

struct Totals {
  int calls = 0;
  int recovered = 0;
  int worst = 0;
};

void try_one(const std::string& call, const Way& way, Totals* totals) {
  std::array<std::string, 2> shown;
  for (const bool is_start : {true, false}) {
    const Outcome outcome = run(call, way.error, is_start);
    // Some calls are not made at the start, so there is nothing to recover from.
    const bool counts = outcome.was_met || !is_start;
    shown[is_start ? 0 : 1] = counts ? text_of(outcome) : "(not called)";
    if (!counts) continue;
    ++totals->calls;
    if (outcome.was_met && outcome.is_well) ++totals->recovered;
    totals->worst = std::max(totals->worst, outcome.refreshes);
  }
  fmt::print("{:<48} {:<8} {:<46} {}\n", call, way.name, shown[0], shown[1]);
}

}  // namespace
}  // namespace cyclorama

int main() {
  using namespace cyclorama;
  fmt::print("{:<48} {:<8} {:<46} {}\n", "call that fails once", "with", "at the start: the wall shows",
             "in the show: the wall shows");
  Totals totals;
  const std::vector<std::string> calls = all_calls();
  for (const std::string& call : calls) {
    if (call == "page flip event") {
      try_one(call, {ETIMEDOUT, "never"}, &totals);
    } else if (call.starts_with("egl")) {
      try_one(call, {EIO, "refused"}, &totals);
    } else {
      for (const Way& way : kWays) try_one(call, way, &totals);
    }
  }
  fmt::print(
      "Counted in refreshes; two cards, four heads. 'All opened anew' is what the display does with a lost output.\n");
  fmt::print(
      "{{\"benchmark\": \"display-faults\", \"calls\": {}, \"recovered\": {}, \"names\": {}, \"worst_refreshes\": "
      "{}}}\n",
      totals.calls, totals.recovered, calls.size(), totals.worst);
  return totals.calls == totals.recovered ? 0 : 1;
}
