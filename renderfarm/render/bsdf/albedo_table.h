// SPDX-License-Identifier: Apache-2.0
/// How much light a rough surface gives back after one bounce between its facets. What is missing from one bounced on:
/// lobes that are added to make it up are built from these numbers.
///
/// Source of the idea: Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017.
#pragma once

#include <array>

#include "renderfarm/render/vectors.h"

namespace cyclorama {

/// One bounce in even light is f0 * low + f90 * high, by Schlick's Fresnel. low + high + lost is 1.
struct BounceAlbedo {
  float low = 1.0f;
  float high = 0.0f;
  float lost = 0.0f;    ///< Kept by itself: it has digits of its own.
  float darker = 0.0f;  ///< What a smooth coat's narrow() takes beyond its reflection, off perfect mirrors.
};

/// The reflectance of a coat's index, 1.5.
inline constexpr float kCoatF0 = 0.04f;

/// Of one roughness, by the cosine of the viewer; and its mean over a cosine-weighted hemisphere. Bilinear, and so the
/// mean is that of the interpolated numbers exactly. Reentrant.
class AlbedoRow {
 public:
  static constexpr int kCosines = 32;
  static constexpr int kWidths = 32;
  using Row = std::array<BounceAlbedo, kCosines>;
  struct Table {
    std::array<Row, kWidths> rows;
    std::array<BounceAlbedo, kWidths> means;
  };

  explicit AlbedoRow(float alpha) : table_(table()) {
    const float at = std::sqrt(alpha) * (kWidths - 1);
    row_ = std::min(static_cast<int>(at), kWidths - 2);
    part_ = std::min(at - static_cast<float>(row_), 1.0f);
  }

  [[nodiscard]] BounceAlbedo at(float cosine) const {
    const float place = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kCosines - 1);
    const auto column = static_cast<std::size_t>(std::min(static_cast<int>(place), kCosines - 2));
    const float part = std::min(place - static_cast<float>(column), 1.0f);
    const Row& below = table_.rows[static_cast<std::size_t>(row_)];
    const Row& above = table_.rows[static_cast<std::size_t>(row_) + 1];
    return between(between(below[column], below[column + 1], part), between(above[column], above[column + 1], part),
                   part_);
  }
  [[nodiscard]] BounceAlbedo mean() const {
    return between(table_.means[static_cast<std::size_t>(row_)], table_.means[static_cast<std::size_t>(row_) + 1],
                   part_);
  }

 private:
  /// Computed at the first call; thread-safe.
  static const Table& table();
  static BounceAlbedo between(const BounceAlbedo& a, const BounceAlbedo& b, float part) {
    return {a.low + (b.low - a.low) * part, a.high + (b.high - a.high) * part, a.lost + (b.lost - a.lost) * part,
            a.darker + (b.darker - a.darker) * part};
  }

  const Table& table_;
  int row_;
  float part_;
};

/// What one bounce loses at the surface of a body of index of refraction `ior`, of what it reflects and lets through
/// together, seen from outside or from inside. Reentrant.
class GlassLoss {
 public:
  static constexpr int kCosines = 16;
  static constexpr int kWidths = 16;
  static constexpr int kIors = 10;              ///< Evenly in the fourth root of their f0.
  using Row = std::array<float, kCosines + 1>;  ///< The last is the mean.
  using Table = std::array<std::array<std::array<Row, 2>, kWidths>, kIors>;

  GlassLoss(float alpha, float ior);

  [[nodiscard]] float at(float cosine, bool inside) const {
    const float place = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kCosines - 1);
    const auto column = static_cast<std::size_t>(std::min(static_cast<int>(place), kCosines - 2));
    const float part = std::min(place - static_cast<float>(column), 1.0f);
    const Row& row = rows_[inside ? 1 : 0];
    return row[column] + (row[column + 1] - row[column]) * part;
  }
  [[nodiscard]] float mean(bool inside) const { return rows_[inside ? 1 : 0][kCosines]; }

 private:
  std::array<Row, 2> rows_;
};

}  // namespace cyclorama
