// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/lamp_fade.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::tour {

void LampFade::open(std::vector<std::string> groups) {
  groups_ = std::move(groups);
  wanted_.assign(groups_.size(), 1.0f);
  levels_ = wanted_;
}

Status LampFade::want(const LampSettings& wanted) {
  std::vector<float> levels = wanted_;
  for (const auto& [name, level] : wanted) {
    const auto group = std::ranges::find(groups_, name);
    if (group == groups_.end()) {
      return Error(ErrorCode::kNotFound,
                   fmt::format("the scene has no group of lamps '{}'; it has {}", printable(name),
                               groups_.empty() ? "none" : printable(fmt::format("{}", fmt::join(groups_, ", ")))));
    }
    if (!(level >= 0.0f && level <= kMaxLampLevel)) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("the level of '{}' is {}; it must be 0 to {}", printable(name), level, kMaxLampLevel));
    }
    levels[static_cast<std::size_t>(group - groups_.begin())] = level;
  }
  wanted_ = std::move(levels);
  return Done{};
}

void LampFade::step(TimePoint now) {
  const Duration passed = now - std::exchange(stepped_at_, now);
  const auto step = static_cast<float>(to_seconds(std::min(passed, kWhole)) / to_seconds(kWhole));
  for (std::size_t i = 0; i < levels_.size(); ++i) levels_[i] += std::clamp(wanted_[i] - levels_[i], -step, step);
}

std::vector<float> LampFade::levels() const {
  const bool is_authored = std::ranges::all_of(levels_, [](float level) { return level == 1.0f; });
  return is_authored ? std::vector<float>() : levels_;
}

}  // namespace cyclorama::tour
