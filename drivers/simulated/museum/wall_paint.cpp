// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/wall_paint.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "drivers/simulated/museum/true_sensor.h"

namespace cyclorama::simulated {
namespace {

constexpr double kPanelGlossExponent = 120.0;

/// A number in [-1, 1] for each cell of a lattice.
double lattice(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto bits = mixed(mixed(mixed(static_cast<std::uint64_t>(x)) ^ static_cast<std::uint64_t>(y)) ^
                          static_cast<std::uint64_t>(z));
  return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
}

/// Noise in [-1, 1] that is interpolated between the corners of cells of one unit.
double grain(const Eigen::Vector3d& at) {
  const Eigen::Vector3d cell = at.array().floor();
  const Eigen::Vector3d in = at - cell;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::int64_t index[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_far = (corner >> axis) % 2 == 1;
      weight *= is_far ? in[axis] : 1.0 - in[axis];
      index[axis] = static_cast<std::int64_t>(cell[axis]) + (is_far ? 1 : 0);
    }
    sum += weight * lattice(index[0], index[1], index[2]);
  }
  return sum;
}

bool is_in(const WallPaint::Panel& panel, const WallPosition& at) {
  return at.across >= panel.left && at.across <= panel.right && at.along >= panel.low && at.along <= panel.high;
}

}  // namespace

double WallPaint::albedo_at(const TrueWall::Hit& at) const {
  double albedo = 1.0;
  for (const Panel& panel : panels) {
    if (is_in(panel, at.position)) albedo = panel.albedo;
  }
  for (const Seam& seam : seams) {
    // The edge of a line is softer than a camera's pixel is wide.
    const double from_middle = (at.position.across - seam.across) / (0.5 * seam.width);
    albedo *= 1.0 - (1.0 - seam.albedo) * std::exp(-from_middle * from_middle);
  }
  if (plaster > 0.0) {
    const Eigen::Vector3d cells = at.point.xyz / plaster_grain_m;
    albedo *= 1.0 + plaster * (0.6 * grain(cells) + 0.4 * grain(0.31 * cells));
  }
  return albedo;
}

double WallPaint::seen_at(const TrueWall::Hit& at, const Eigen::Vector3d& source, const Eigen::Vector3d& eye) const {
  if (is_plain()) return 1.0;
  const Eigen::Vector3d from = (at.point.xyz - source).normalized();
  const Eigen::Vector3d mirrored = from - 2.0 * from.dot(at.normal) * at.normal;
  const double cosine = std::max(0.0, mirrored.dot((eye - at.point.xyz).normalized()));
  double seen = albedo_at(at) + sheen * std::pow(cosine, sheen_exponent);
  for (const Panel& panel : panels) {
    if (is_in(panel, at.position)) seen += panel.gloss * std::pow(cosine, kPanelGlossExponent);
  }
  return seen;
}

}  // namespace cyclorama::simulated
