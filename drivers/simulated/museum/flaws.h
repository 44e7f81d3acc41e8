// SPDX-License-Identifier: Apache-2.0
/// How real museums differ from plans: drawn at random, in the sizes that installers report. Knows the truth: see
/// truth.h.
#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/simulated/museum/truth.h"

namespace cyclorama::simulated {

/// Random numbers that are the same everywhere, in streams that do not disturb each other. A value.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}
  [[nodiscard]] RandomStream stream(std::string_view name) const;
  /// The next one, evenly distributed.
  double between(double min, double max);
  double about_zero(double max) { return between(-max, max); }

 private:
  std::uint64_t state_;
};

/// The distance from the axis goes through exactly [least, most] along the arc, in about one wave.
/// Precondition: the wall is a cylinder.
void bend_wall(RandomStream draws, double min_m, double max_m, MuseumTruth* truth);
/// The wall leans by 1.5 to 4 degrees about its lower middle, anywhere.
void tilt_wall(RandomStream draws, MuseumTruth* truth);
/// Waves and dents of 0.5 to 3 cm.
void dent_wall(RandomStream draws, MuseumTruth* truth);
/// Of projectors, camera, turntable and paint.
void add_flaws(const RandomStream& draws, MuseumTruth* truth);

}  // namespace cyclorama::simulated
