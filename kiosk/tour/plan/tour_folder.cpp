// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/tour_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "kiosk/tour/plan/tour_plan_text.h"

namespace cyclorama::tour {
namespace {

bool has_stop(const TourPlan& plan, const std::string& name) {
  return std::ranges::any_of(plan.stops, [&](const PlannedStop& planned) { return planned.stop.name == name; });
}

std::string free_name(const TourPlan& plan) {
  std::size_t number = 1;
  while (has_stop(plan, fmt::format("stop-{}", number))) ++number;
  return fmt::format("stop-{}", number);
}

/// Returns the position in whole millimetres where that is allowed too, so that people can read it.
Eigen::Vector2d rounded(const Eigen::Vector2d& position, const WalkableArea& area) {
  const Eigen::Vector2d whole = (position * 1e3).array().round() / 1e3;
  return area.allows(whole) ? whole : position;
}

}  // namespace

Result<std::string> TourFolder::read() const { return read_text_file(file(), kMaxTourFileBytes); }

Status TourFolder::read_captions(TourPlan* plan) const {
  std::size_t bytes = 0;
  for (PlannedStop& stop : plan->stops) {
    for (const auto& [language, file] : stop.caption_files) {
      const std::string path = (folder_ / file).string();
      TRY_ASSIGN(const std::string text, read_text_file(path, kMaxCueFileBytes));
      bytes += text.size();
      if (bytes > kMaxCaptionBytes)
        return Error(ErrorCode::kBadData, fmt::format("{}: all captions of a tour have at most {} MiB; shorten some",
                                                      path, kMaxCaptionBytes >> 20U));
      TRY_ASSIGN(stop.captions[language], parse_webvtt(text, path));
    }
  }
  return Done{};
}

std::vector<std::filesystem::file_time_type> TourFolder::caption_times(const TourPlan& plan) const {
  std::vector<std::filesystem::file_time_type> times;
  for (const PlannedStop& stop : plan.stops) {
    for (const auto& [language, file] : stop.caption_files) {
      std::error_code missing;
      const auto time = std::filesystem::last_write_time(folder_ / file, missing);
      times.push_back(missing ? std::filesystem::file_time_type() : time);
    }
  }
  return times;
}

Result<std::string> TourFolder::add(PlannedStop planned, const TourPlan& otherwise, const WalkableArea& area) const {
  auto before = read();
  if (!before && before.error().code() != ErrorCode::kNotFound) return std::move(before).error();
  const std::string text = before ? *before : to_toml(otherwise);
  TourPlan plan = otherwise;
  if (before) {
    TRY_ASSIGN(plan, parse_tour_plan(text, file().string(), &area));
  }
  std::string& name = planned.stop.name;
  if (name.empty()) name = free_name(plan);
  if (!is_stop_name(name)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is no stop's name; use 1 to 40 letters of a to z, digits and '-'", printable(name)));
  }
  if (has_stop(plan, name))
    return Error(ErrorCode::kInvalidArgument, fmt::format("a stop is called '{}' already; choose another name", name));
  // The title is in whatever language the tour begins with.
  if (!planned.title.empty()) planned.title = {{plan.languages.front(), planned.title.begin()->second}};
  planned.stop.position_m = rounded(planned.stop.position_m, area);
  const std::string after = text + (text.ends_with('\n') ? "\n" : "\n\n") + to_toml(planned);
  const auto valid = parse_tour_plan(after, file().string(), &area);
  if (!valid) return Error(ErrorCode::kInvalidArgument, valid.error().message());
  TRY(replace(after, before ? *before : ""));
  return name;
}

Status TourFolder::undo() const {
  const auto earlier = read_text_file(before(), kMaxTourFileBytes);
  if (!earlier && earlier.error().code() == ErrorCode::kNotFound)
    return Error(ErrorCode::kNotFound, fmt::format("nothing in '{}' can be undone", folder_.string()));
  if (!earlier) return earlier.error();
  const auto now = read();
  return replace(*earlier, now ? *now : "");
}

Status TourFolder::replace(const std::string& text, const std::string& before_text) const {
  TRY(write_file_atomically(before(), std::string_view(before_text)));
  if (!text.empty()) return write_file_atomically(file(), std::string_view(text));
  // Before the first stop there was no tour.
  std::error_code error;
  std::filesystem::remove(file(), error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("removing '{}': {}", file().string(), error.message()));
  return Done{};
}

}  // namespace cyclorama::tour
