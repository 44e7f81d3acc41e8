// SPDX-License-Identifier: Apache-2.0
#include "common/process/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace cyclorama {
namespace {
constexpr int kBarWidth = 40;
constexpr auto kRedraw = std::chrono::milliseconds(100);
}  // namespace

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_ && shown_ >= 0.0) std::fputs("\n", stderr);
}

void Progress::set_step(const std::string& what) {
  if (what == what_) return;
  what_ = what;
  is_new_step_ = true;
}

void Progress::update(double fraction) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  const TimePoint now = SteadyClock().now();
  if (terminal_) {
    if (fraction < 1.0 && now - drawn_at_ < kRedraw) return;
    const int full = static_cast<int>(std::lround(fraction * kBarWidth));
    // Clears what remains of a longer line printed before.
    fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {:3.0f} %\x1b[K", what_, "", full, "", kBarWidth - full,
               100.0 * fraction);
    std::fflush(stderr);
  } else {
    if (fraction < 1.0 && fraction < shown_ + 0.1 && !is_new_step_) return;
    fmt::print(stderr, "{}: {:.0f} %\n", what_, 100.0 * fraction);
  }
  is_new_step_ = false;
  shown_ = fraction;
  drawn_at_ = now;
}

}  // namespace cyclorama
