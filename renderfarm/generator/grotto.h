// SPDX-License-Identifier: Apache-2.0
/// A painted cave temple of any number of triangles, in the spirit of Mogao cave 158 at Dunhuang (eighth to ninth
/// century): the Buddha entering nirvana on a long altar, mourned by his disciples. Everything is made from formulas.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/generator/furnishings.h"
#include "renderfarm/generator/geometry_sink.h"
#include "renderfarm/generator/surface.h"

namespace cyclorama::grotto {

inline constexpr std::uint64_t kFewestTriangles = 10'000;
inline constexpr std::uint64_t kMostTriangles = 60'000'000;

enum class Kind { kGrotto, kInterior, kRelic };

/// A value: what will be made, without a vertex of it.
struct Grotto {
  Kind kind = Kind::kGrotto;
  std::vector<Part> parts;
  std::vector<Lamp> lamps;

  [[nodiscard]] GeometryCounts counts() const;
};

/// kInvalidArgument outside [kFewestTriangles, kMostTriangles].
Status check_triangles(std::uint64_t triangles);

/// At most `triangles` triangles, and at least 98 % of them. The seed decides where the rock is broken, where paint has
/// flaked, and who stands where. kInvalidArgument outside [kFewestTriangles, kMostTriangles].
Result<Grotto> plan_grotto(std::uint64_t triangles, std::uint32_t seed);

/// Asked about ten times a second, on the calling thread, with the fraction done; false stops the work.
using KeepGoing = std::function<bool(double)>;

/// Computes all parts and gives each to a file of `sink`. What arrives there depends on the grotto alone, not on
/// `threads` (at least 1); memory is some rows per thread. Blocks. The sink's errors; kUnavailable when stopped.
Status generate(const Grotto& grotto, GeometrySink& sink, int threads, const KeepGoing& keep_going);

}  // namespace cyclorama::grotto
