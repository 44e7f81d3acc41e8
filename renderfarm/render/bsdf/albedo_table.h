// SPDX-License-Identifier: Apache-2.0
/// Albedo of a rough surface for light that leaves it after a single bounce off a microfacet. The lobes that compensate
/// for the light of further bounces are computed from these values.
///
/// Source of the idea: Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017.
#pragma once

#include <array>

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Albedo of one bounce: under uniform illumination it reflects f0 * low + f90 * high, by Schlick's approximation of
/// Fresnel reflectance. low + high + lost is 1.
struct BounceAlbedo {
  float low = 1.0f;
  float high = 0.0f;
  float lost = 0.0f;  ///< Stored, because 1 - low - high would be imprecise.
  /// Light that Coat::narrow() of a smooth coat removes beyond what the coat reflects, if the facets below are perfect
  /// mirrors.
  float darker = 0.0f;
};

/// Reflectance at normal incidence of a coat with ior 1.5.
inline constexpr float kCoatF0 = 0.04f;

/// Albedos for one roughness, by the cosine of the viewer, and their mean over a cosine-weighted hemisphere. Bilinear
/// interpolation makes the mean exactly that of the interpolated values. Reentrant.
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
  /// Returns the table, which is computed at the first call. Thread-safe.
  static const Table& table();
  static BounceAlbedo between(const BounceAlbedo& a, const BounceAlbedo& b, float part) {
    return {a.low + (b.low - a.low) * part, a.high + (b.high - a.high) * part, a.lost + (b.lost - a.lost) * part,
            a.darker + (b.darker - a.darker) * part};
  }

  const Table& table_;
  int row_;
  float part_;
};

/// Share of light that neither leaves the rough surface of a body upwards nor passes it downwards after one bounce. The
/// body has the index of refraction `ior` and is seen from outside or from inside. Reentrant.
class GlassLoss {
 public:
  static constexpr int kCosines = 16;
  static constexpr int kWidths = 16;
  static constexpr int kIors = 10;              ///< Evenly spaced in the fourth root of their f0.
  using Row = std::array<float, kCosines + 1>;  ///< The last element is the mean.
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

}  // namespace cyclorama::render
