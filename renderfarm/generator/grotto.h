// SPDX-License-Identifier: Apache-2.0
/// A painted cave temple with any number of triangles, modelled on Mogao cave 158 at Dunhuang (eighth to ninth
/// century): the Buddha entering nirvana on a long altar, mourned by his disciples. Everything is computed from
/// formulas.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/generator/furnishings.h"
#include "renderfarm/generator/geometry_sink.h"
#include "renderfarm/generator/surface.h"

namespace cyclorama::generator {

inline constexpr std::uint64_t kMinTriangles = 10'000;
inline constexpr std::uint64_t kMaxTriangles = 60'000'000;

enum class Kind { kGrotto, kInterior, kRelic };

/// A value: a description of the geometry without any vertices.
struct Grotto {
  Kind kind = Kind::kGrotto;
  std::vector<Part> parts;
  std::vector<Lamp> lamps;

  [[nodiscard]] GeometryCounts counts() const;
};

/// Checks a number of triangles. Errors: kInvalidArgument outside [kMinTriangles, kMaxTriangles].
Status check_triangles(std::uint64_t triangles);

/// Plans a grotto of at most `triangles` triangles, and at least 98 % of that number. The seed determines where the
/// rock is broken and paint has flaked off, and the order of the figures. Errors: those of check_triangles().
Result<Grotto> plan_grotto(std::uint64_t triangles, std::uint32_t seed);

/// Called about ten times a second, on the calling thread, with the fraction done; returns false to stop the work.
using KeepGoing = std::function<bool(double)>;

/// Computes all parts and writes each to a file of `sink`. The output depends on the grotto alone, not on `threads` (at
/// least 1); generate() takes memory for some rows per thread. Blocks until all is written. Errors: those of the sink;
/// kUnavailable if stopped.
Status generate(const Grotto& grotto, GeometrySink& sink, int threads, const KeepGoing& keep_going);

}  // namespace cyclorama::generator
