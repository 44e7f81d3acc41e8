// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/common_gamut.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama::photometry {
namespace {

constexpr double kMinGamutArea = 1e-4;  // Minimum area of a chromaticity triangle; that of all colours is 0.5.

using Polygon = std::vector<Eigen::Vector2d>;

/// Returns the chromaticity: red and green as fractions of the sum of the channels.
Eigen::Vector2d chromaticity(const Eigen::Vector3d& colour) {
  const double sum = colour.sum();
  return {colour.x() / sum, colour.y() / sum};
}
Eigen::Vector3d colour_of(const Eigen::Vector2d& c) { return {c.x(), c.y(), 1.0 - c.x() - c.y()}; }

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double twice_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, c - a);
}

/// Returns the part of a polygon inside a triangle, which is counterclockwise. Source: Sutherland and Hodgman,
/// "Reentrant Polygon Clipping", CACM 17 (1), 1974.
Polygon clipped(Polygon polygon, const std::array<Eigen::Vector2d, 3>& triangle) {
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const Eigen::Vector2d a = triangle.at(edge);
    const Eigen::Vector2d along = triangle.at((edge + 1) % 3) - a;
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d& p = polygon[i];
      const Eigen::Vector2d& q = polygon[(i + 1) % polygon.size()];
      const double at_p = cross(along, p - a);
      const double at_q = cross(along, q - a);
      if (at_p >= 0.0) kept.push_back(p);
      if ((at_p >= 0.0) != (at_q >= 0.0)) kept.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

/// Merges corners that coincide within rounding.
Polygon tidied(const Polygon& polygon) {
  Polygon result;
  for (const Eigen::Vector2d& p : polygon) {
    const bool is_known = std::ranges::any_of(result, [&p](const auto& q) { return (p - q).norm() < 1e-9; });
    if (!is_known) result.push_back(p);
  }
  return result;
}

std::array<Eigen::Vector2d, 3> triangle_of(const Eigen::Matrix3d& primaries) {
  return {chromaticity(primaries.col(0)), chromaticity(primaries.col(1)), chromaticity(primaries.col(2))};
}

/// Returns the largest triangle of three corners, ordered so that its corners are nearest to red, green and blue.
std::array<Eigen::Vector2d, 3> largest_triangle(const Polygon& polygon, const std::array<Eigen::Vector2d, 3>& wanted) {
  std::array<Eigen::Vector2d, 3> best = wanted;
  double best_area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    for (std::size_t j = i + 1; j < polygon.size(); ++j) {
      for (std::size_t k = j + 1; k < polygon.size(); ++k) {
        const double area = std::abs(twice_area(polygon[i], polygon[j], polygon[k]));
        if (!(area > best_area)) continue;
        best_area = area;
        best = {polygon[i], polygon[j], polygon[k]};
      }
    }
  }
  std::array<std::size_t, 3> order = {0, 1, 2};
  std::array<std::size_t, 3> nearest = order;
  double min = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) sum += (best.at(order.at(i)) - wanted.at(i)).squaredNorm();
    if (!(sum < min)) continue;
    min = sum;
    nearest = order;
  } while (std::ranges::next_permutation(order).found);
  return {best.at(nearest[0]), best.at(nearest[1]), best.at(nearest[2])};
}

/// Returns the white of luminance 1 whose largest channel is smallest. This is a linear programme in two unknowns,
/// whose solution is a point where three of its bounds meet.
Eigen::Vector3d cheapest_white(const std::vector<Eigen::Matrix3d>& inverses, const Eigen::Vector3d& luminance) {
  std::vector<Eigen::Vector3d> rows;
  for (const Eigen::Matrix3d& inverse : inverses) {
    for (int c = 0; c < 3; ++c) rows.emplace_back(inverse.row(c).transpose());
  }
  const auto cost = [&rows](const Eigen::Vector3d& white) {
    double max = -std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& row : rows) max = std::max(max, row.dot(white));
    return max;
  };
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = i + 1; j < rows.size(); ++j) {
      for (std::size_t k = j + 1; k < rows.size(); ++k) {
        Eigen::Matrix3d meeting;
        meeting << rows[i].transpose(), rows[j].transpose(), rows[k].transpose();
        if (!(std::abs(meeting.determinant()) > 1e-12)) continue;
        // The white for which these three channels are equal, scaled to luminance 1.
        Eigen::Vector3d white = meeting.inverse() * Eigen::Vector3d::Ones();
        const double light = luminance.dot(white);
        if (!(light > 1e-9)) continue;
        white /= light;
        const double worst = cost(white);
        if (worst < min) {
          min = worst;
          best = white;
        }
      }
    }
  }
  return best;
}

}  // namespace

Result<CommonGamut> common_gamut(std::span<const Eigen::Matrix3d> primaries, const Eigen::Vector3d& luminance,
                                 std::span<const std::string> names) {
  Polygon polygon;
  std::array<Eigen::Vector2d, 3> mean = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  std::vector<Eigen::Matrix3d> inverses;
  CommonGamut result;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < primaries.size(); ++p) {
    const Eigen::Vector3d sums = primaries[p].colwise().sum();
    std::array<Eigen::Vector2d, 3> triangle = triangle_of(primaries[p]);
    const double area = twice_area(triangle[0], triangle[1], triangle[2]);
    if (!(sums.minCoeff() > 0.0) || !(std::abs(area) > kMinGamutArea)) {
      return Error(
          ErrorCode::kBadData,
          fmt::format("projector '{}': its red, green and blue look alike to the camera; look whether it shows "
                      "colours, and whether the camera delivers them",
                      names[p]));
    }
    for (std::size_t c = 0; c < 3; ++c) mean.at(c) += triangle.at(c) / static_cast<double>(primaries.size());
    if (area < 0.0) std::swap(triangle[1], triangle[2]);
    smallest = std::min(smallest, std::abs(area));
    polygon = p == 0 ? Polygon(triangle.begin(), triangle.end()) : clipped(std::move(polygon), triangle);
    inverses.push_back(primaries[p].inverse());
    if (polygon.size() < 3) {
      return Error(ErrorCode::kBadData,
                   fmt::format("projector '{}' has no colours in common with the others; choose the same picture mode "
                               "on all projectors",
                               names[p]));
    }
  }
  const auto corners = largest_triangle(tidied(polygon), mean);
  const double area = std::abs(twice_area(corners[0], corners[1], corners[2]));
  if (!(area > kMinGamutArea)) {
    return Error(ErrorCode::kBadData,
                 "the projectors have hardly any colours in common; choose the same picture mode on all of them");
  }
  result.area_kept = std::min(1.0, area / smallest);
  Eigen::Matrix3d directions;
  for (int c = 0; c < 3; ++c) directions.col(c) = colour_of(corners.at(static_cast<std::size_t>(c)));
  Eigen::Vector3d white = cheapest_white(inverses, luminance);
  Eigen::Vector3d shares = directions.inverse() * white;
  if (!(shares.minCoeff() > 1e-3 * shares.maxCoeff())) {
    // The optimal white lies outside the triangle; every projector can show the triangle's centre.
    white = directions * Eigen::Vector3d::Ones();
    white /= luminance.dot(white);
    shares = directions.inverse() * white;
  }
  result.wall = directions * shares.asDiagonal();
  for (const Eigen::Matrix3d& inverse : inverses) {
    // Negative entries come from rounding only.
    const Eigen::Matrix3d matrix = (inverse * result.wall).cwiseMax(0.0);
    const double max = matrix.rowwise().sum().maxCoeff();
    result.matrices.emplace_back(matrix / max);
    result.kept.push_back(1.0 / max);
  }
  return result;
}

}  // namespace cyclorama::photometry
