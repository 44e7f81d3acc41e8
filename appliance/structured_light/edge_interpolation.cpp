// SPDX-License-Identifier: Apache-2.0
#include "appliance/structured_light/edge_interpolation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace cyclorama::structured_light {
namespace {

constexpr int kLevels = 4;
/// Maximum gap of undecided pixels across an edge: with XOR codes, pixels whose base bit is undecided have no stripe.
constexpr std::size_t kMaxBridge = 4;
/// Edges farther apart than this many camera pixels do not determine positions between them.
constexpr double kFurthestEdges = 96.0;
/// Error of the interpolation between edges, in stripes, measured against planes on real captures
/// (docs/design/structured-light.md).
constexpr double kModelSigma = 0.02;
/// Error of the linear interpolation of an edge between two camera pixels, in camera pixels.
constexpr double kCrossingSigma = 0.05;

struct Crossing {
  double at = 0.0;     ///< In camera pixels along the line; 0 is the centre of the first pixel.
  double sigma = 0.0;  ///< Standard deviation of `at`.
  int boundary = 0;    ///< The edge between the cells boundary - 1 and boundary.
  bool begins = true;  ///< True if nothing is known between the previous crossing and this one.
};

/// Follows the edges along a row or a column of the photograph.
class Line {
 public:
  Line(const AxisBits& axis, const StripeReading& reading, const Image<float, 1>& amplitude,
       const Image<std::uint8_t, 1>& is_lit, double noise, int level)
      : axis_(axis), reading_(reading), amplitude_(amplitude), is_lit_(is_lit), noise_(noise), level_(level) {}

  void follow(std::size_t start, std::size_t stride, std::size_t count) {
    start_ = start;
    stride_ = stride;
    crossings_.clear();
    begins_ = true;
    std::size_t before = count;  // `count` means none.
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = pixel(i);
      if (is_lit_.data()[p] == 0) {
        before = count;
        continue;
      }
      if (!is_settled(reading_.position.data()[p], reading_.undecided.data()[p], level_)) continue;
      if (before == count || i - before > kMaxBridge) {
        begins_ = true;
      } else {
        add_between(before, i);
      }
      before = i;
    }
  }

  void fill(AxisPositions* positions) const {
    const double cell_px = std::ldexp(1.0, level_);
    for (std::size_t k = 1; k < crossings_.size(); ++k) {
      const Crossing& a = crossings_[k - 1];
      const Crossing& b = crossings_[k];
      const double gap = b.at - a.at;
      if (b.begins || std::abs(a.boundary - b.boundary) != 1 || !(gap > 1e-3) || gap > kFurthestEdges) continue;
      for (auto i = static_cast<std::size_t>(std::ceil(a.at)); static_cast<double>(i) <= b.at; ++i) {
        const double share = (static_cast<double>(i) - a.at) / gap;
        const double sigma =
            cell_px * std::hypot(std::hypot((1.0 - share) * a.sigma, share * b.sigma) / gap, kModelSigma);
        const double position = cell_px * (a.boundary + share * (b.boundary - a.boundary));
        keep(pixel(i), position, sigma, positions);
      }
    }
  }

  static void keep(std::size_t p, double position, double sigma, AxisPositions* positions) {
    float& best = positions->sigma_px.data()[p];
    if (best >= 0.0f && static_cast<double>(best) <= sigma) return;
    best = static_cast<float>(sigma);
    positions->position_px.data()[p] = static_cast<float>(position);
  }

 private:
  [[nodiscard]] std::size_t pixel(std::size_t i) const { return start_ + i * stride_; }
  /// Returns pattern minus inverse relative to the pixel's amplitude, so that the wall's colour does not shift an edge.
  [[nodiscard]] double profile(int bit, std::size_t i) const {
    const std::size_t p = pixel(i);
    const auto difference = static_cast<double>(axis_.differences[static_cast<std::size_t>(bit)].data()[p]);
    return difference /
           (static_cast<double>(kDifferenceScale) * std::max(1e-3, static_cast<double>(amplitude_.data()[p])));
  }

  /// Adds the edges between two settled pixels of the line.
  void add_between(std::size_t a, std::size_t b) {
    const int from = reading_.position.data()[pixel(a)] >> level_;
    const int to = reading_.position.data()[pixel(b)] >> level_;
    if (from == to) return;
    // With three edges, two would be of the same bit and their order ambiguous.
    if (std::abs(to - from) > 2) {
      begins_ = true;
      return;
    }
    const std::size_t first = crossings_.size();
    const int step = to > from ? 1 : -1;
    for (int cell = from; cell != to; cell += step) {
      const int boundary = std::max(cell, cell + step);
      if (!add_edge(a, b, boundary)) {
        crossings_.resize(first);
        begins_ = true;
        return;
      }
    }
    if (crossings_.size() == first + 2 && crossings_[first].at > crossings_[first + 1].at) {
      // The edges are blurred into each other, and the stripe between them is not visible.
      crossings_.resize(first);
      begins_ = true;
    }
  }

  bool add_edge(std::size_t a, std::size_t b, int boundary) {
    const int bit = level_ + std::countr_zero(static_cast<unsigned>(boundary));
    if (bit >= axis_.bits) return false;
    const bool rises = profile(bit, b) > 0.0;
    if ((profile(bit, a) > 0.0) == rises) return false;
    std::size_t i = a;
    while ((profile(bit, i + 1) > 0.0) != rises) ++i;  // Ends at b at the latest.
    const double low = profile(bit, i);
    const double high = profile(bit, i + 1);
    const double difference = high - low;
    const double sigma_profile =
        std::numbers::sqrt2 * noise_ / std::max(1e-3, static_cast<double>(amplitude_.data()[pixel(i)]));
    crossings_.push_back({.at = static_cast<double>(i) - low / difference,
                          .sigma = std::min(std::hypot(sigma_profile / std::abs(difference), kCrossingSigma), 0.5),
                          .boundary = boundary,
                          .begins = begins_});
    begins_ = false;
    return true;
  }

  const AxisBits& axis_;
  const StripeReading& reading_;
  const Image<float, 1>& amplitude_;
  const Image<std::uint8_t, 1>& is_lit_;
  double noise_;
  int level_;
  std::size_t start_ = 0;
  std::size_t stride_ = 1;
  bool begins_ = true;
  std::vector<Crossing> crossings_;
};

}  // namespace

AxisPositions interpolate_edges(const AxisBits& axis, const StripeReading& reading, const Image<float, 1>& amplitude,
                                const Image<std::uint8_t, 1>& is_lit, double noise) {
  const int width = amplitude.width();
  const int height = amplitude.height();
  AxisPositions positions{Image<float, 1>(width, height, 0.0f), Image<float, 1>(width, height, -1.0f)};
  const auto columns = static_cast<std::size_t>(width);
  const auto rows = static_cast<std::size_t>(height);
  for (int level = axis.finest_bit; level < std::min(axis.finest_bit + kLevels, axis.bits); ++level) {
    const double cell_px = std::ldexp(1.0, level);
    for (std::size_t p = 0; p < columns * rows; ++p) {
      if (is_lit.data()[p] == 0 || !is_settled(reading.position.data()[p], reading.undecided.data()[p], level))
        continue;
      const double middle = cell_px * ((reading.position.data()[p] >> level) + 0.5);
      Line::keep(p, middle, cell_px / std::sqrt(12.0), &positions);
    }
    Line line(axis, reading, amplitude, is_lit, noise, level);
    for (std::size_t y = 0; y < rows; ++y) {
      line.follow(y * columns, 1, columns);
      line.fill(&positions);
    }
    for (std::size_t x = 0; x < columns; ++x) {
      line.follow(x, columns, rows);
      line.fill(&positions);
    }
  }
  return positions;
}

}  // namespace cyclorama::structured_light
