// SPDX-License-Identifier: Apache-2.0
/// Differences between real museums and their plans, drawn at random in the sizes that installers report. Contains the
/// truth: see truth.h for its permitted users.
#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/simulated/museum/truth.h"

namespace cyclorama::simulated {

/// Random numbers that are the same on every platform, in independent streams. A value.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}
  [[nodiscard]] RandomStream stream(std::string_view name) const;
  /// Returns the next number, uniformly distributed.
  double between(double min, double max);
  double about_zero(double max) { return between(-max, max); }

 private:
  std::uint64_t state_;
};

/// Bends the wall so that its distance from the axis spans exactly [min_m, max_m] along the arc, in about one wave.
/// Precondition: the wall is a cylinder.
void bend_wall(RandomStream draws, double min_m, double max_m, MuseumTruth* truth);
/// Tilts the wall by 1.5 to 4 degrees, in any direction, about the point of the room's axis at eye height.
void tilt_wall(RandomStream draws, MuseumTruth* truth);
/// Adds waves and dents of 0.5 to 3 cm.
void dent_wall(RandomStream draws, MuseumTruth* truth);
/// Adds flaws to projectors, camera, turntable and paint.
void add_flaws(const RandomStream& draws, MuseumTruth* truth);

}  // namespace cyclorama::simulated
