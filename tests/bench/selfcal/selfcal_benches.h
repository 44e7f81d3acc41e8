// SPDX-License-Identifier: Apache-2.0
/// Each prints a table and, last, a line of JSON; the answer is the process's exit status.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/records.h"
#include "tests/support/bumped_show.h"

namespace cyclorama {

/// Bumps are drawn by their numbers.
struct BumpSeries {
  std::uint32_t first = 1;
  std::uint32_t count = 60;
  bool is_small = false;
};
/// Half as fine as a museum's, for a look that takes a minute: projectors of 960x540, cameras of 0.3 megapixels.
void make_small(BumpedShowOptions* options);
int bumps(const ShowContent& content, const BumpSeries& series);
int quiet(const ShowContent& content, bool is_quick, const Records::Options& kept);
struct DriftSeries {
  int minutes = 15;
  int looks_per_s = 4;
  bool is_small = false;
};
int drift(const ShowContent& content, const DriftSeries& series);
/// Cases are counted from 0; of the quick ones every other.
int occlusion(const ShowContent& content, bool is_quick, std::size_t first);
int constraints(const ShowContent& content, bool is_quick);
int cost(const ShowContent& content, bool is_quick);
/// Of refreshes, without and with a calibration beside.
struct Pacing {
  double p99_off_ms = 0.0;
  double p99_on_ms = 0.0;
  double late_off = 0.0;  ///< Part of them that came half a refresh late or more.
  double late_on = 0.0;
};
std::optional<Pacing> measure_pacing(const ShowContent& content, bool is_quick);
int features(const ShowContent& content, bool is_quick);
struct Extremes {
  int cases = 0;
  int failures = 0;
};
/// The filter over very many steps with very unequal noises; the room where hardly anything holds it.
int extremes(const ShowContent& content, bool is_quick);
/// Nothing where a room cannot be made.
std::optional<Extremes> room_extremes(const ShowContent& content);
/// What the rate, patches, cameras' pixels and the filter's window cost and gain; the points go into a JSON file too.
int trade(const ShowContent& content, bool is_quick, const Records::Options& options, const std::string& json);
int pictures(const ShowContent& content, const std::string& folder);

/// Percentile of a list, nearest rank; -1 of none.
[[nodiscard]] double percentile(std::vector<double> values, double part);
/// A correction is wrong if its projector is farther off with it than before, by more than this.
inline constexpr double kWrong_px = 0.5;

}  // namespace cyclorama
