// SPDX-License-Identifier: Apache-2.0
/// The benches of the continuous calibration. Each prints a table and finally a line of JSON, and returns an exit code.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/records.h"
#include "tests/support/bumped_show.h"

namespace cyclorama {

/// Bumps are generated from their numbers.
struct BumpSeries {
  std::uint32_t first = 1;
  std::uint32_t count = 60;
  bool is_small = false;
};
/// Halves the resolution for a quick run of about a minute: projectors of 960x540, cameras of 0.3 megapixels.
void make_small(BumpedShowOptions* options);
int bumps(const ShowContent& content, const BumpSeries& series);
int quiet(const ShowContent& content, bool is_quick, const Records::Options& kept);
struct DriftSeries {
  int minutes = 15;
  int looks_per_s = 4;
  bool is_small = false;
};
int drift(const ShowContent& content, const DriftSeries& series);
/// Cases are counted from 0; a quick run uses every other one.
int occlusion(const ShowContent& content, bool is_quick, std::size_t first);
int constraints(const ShowContent& content, bool is_quick);
int cost(const ShowContent& content, bool is_quick);
/// Pacing of refreshes, without (off) and with (on) a calibration on the same machine.
struct Pacing {
  double p99_off_ms = 0.0;
  double p99_on_ms = 0.0;
  double late_off = 0.0;  ///< Fraction of refreshes that were late by half a refresh or more.
  double late_on = 0.0;
};
std::optional<Pacing> measure_pacing(const ShowContent& content, bool is_quick);
int features(const ShowContent& content, bool is_quick);
struct Extremes {
  int cases = 0;
  int failures = 0;
};
/// Runs the filter over very many steps with very unequal noises, and rooms with hardly any constraint.
int extremes(const ShowContent& content, bool is_quick);
/// Returns nothing if a room cannot be made.
std::optional<Extremes> room_extremes(const ShowContent& content);
/// Measures cost and gain of the rate, the patches, the cameras' pixels and the filter's window; also writes the points
/// to a JSON file.
int trade(const ShowContent& content, bool is_quick, const Records::Options& options, const std::string& json);
int pictures(const ShowContent& content, const std::string& folder);

/// Percentile of a list by nearest rank; -1 for an empty list.
[[nodiscard]] double percentile(std::vector<double> values, double part);
/// A correction is wrong if it increases its projector's error by more than this.
inline constexpr double kWrong_px = 0.5;

}  // namespace cyclorama
