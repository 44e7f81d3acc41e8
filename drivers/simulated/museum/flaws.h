// SPDX-License-Identifier: Apache-2.0
/// How real museums differ from plans: drawn at random, in the sizes that installers report. Knows the truth: see
/// truth.h.
#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/simulated/museum/truth.h"

namespace cyclorama {

/// Random numbers that are the same everywhere, in streams that do not disturb each other. A value.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : state_(seed) {}
  [[nodiscard]] Draws stream(std::string_view name) const;
  /// The next one, evenly distributed.
  double between(double least, double most);
  double about_zero(double most) { return between(-most, most); }

 private:
  std::uint64_t state_;
};

/// The distance from the axis goes through exactly [least, most] along the arc, in about one wave.
/// Precondition: the wall is a cylinder.
void bend_wall(Draws draws, double least_m, double most_m, MuseumTruth* truth);
/// The wall leans by 1.5 to 4 degrees about its lower middle, anywhere.
void tilt_wall(Draws draws, MuseumTruth* truth);
/// Waves and dents of 0.5 to 3 cm.
void dent_wall(Draws draws, MuseumTruth* truth);
/// Of projectors, camera, plate and paint.
void add_flaws(const Draws& draws, MuseumTruth* truth);

}  // namespace cyclorama
