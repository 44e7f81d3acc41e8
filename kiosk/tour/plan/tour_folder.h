// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "kiosk/tour/plan/tour_plan.h"

namespace cyclorama::tour {

/// The folder of a curator's tour: tour.toml, and tour.before.toml, the file before the last change by add() or undo().
/// Every change leaves a valid tour, and the curator's comments. A value.
class TourFolder {
 public:
  explicit TourFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] std::filesystem::path file() const { return folder_ / "tour.toml"; }
  /// Returns the text of tour.toml. Errors: those of read_text_file().
  [[nodiscard]] Result<std::string> read() const;
  /// Reads the files of captions that the plan names. Errors: those of parse_webvtt() and of the files, and kBadData if
  /// all of them together are larger than kMaxCaptionBytes.
  [[nodiscard]] Status read_captions(TourPlan* plan) const;
  /// Returns the times at which the plan's files of captions were written last; a file that is missing has none.
  [[nodiscard]] std::vector<std::filesystem::file_time_type> caption_times(const TourPlan& plan) const;
  /// Adds a stop after the others; an empty name becomes the first free one of stop-1, stop-2 and so on. Without a
  /// tour.toml, begins with `otherwise`. Returns the name. Errors: kInvalidArgument for a name that another
  /// stop has, or an impossible name or title; those of parse_tour_plan() and of the files.
  Result<std::string> add(PlannedStop stop, const TourPlan& otherwise, const WalkableArea& area) const;
  /// Exchanges tour.toml and the file before it. Errors: kNotFound if there is none; those of the files.
  [[nodiscard]] Status undo() const;

 private:
  [[nodiscard]] std::filesystem::path before() const { return folder_ / "tour.before.toml"; }
  [[nodiscard]] Status replace(const std::string& text, const std::string& before) const;
  std::filesystem::path folder_;
};

inline constexpr std::size_t kMaxTourFileBytes = std::size_t{1} << 20;
inline constexpr std::size_t kMaxCaptionBytes = std::size_t{32} << 20;

}  // namespace cyclorama::tour
