// SPDX-License-Identifier: Apache-2.0
/// A wall lit by a projector and seen by a camera, given by formulas, to test decoding against a known truth.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "appliance/structured_light/decoder.h"
#include "appliance/structured_light/pattern_drawing.h"
#include "appliance/structured_light/pattern_set.h"
#include "appliance/structured_light/photo.h"

namespace cyclorama {

/// A value; each photograph of one wall has its own noise, selected by its number.
struct LitWall {
  int camera_width_px = 160;
  int camera_height_px = 120;
  /// Maps a camera position (first pixel's centre at (0.5, 0.5)) to the projector pixel that lights it.
  std::function<Eigen::Vector2d(double u, double v)> projector_pixel_at = [](double u, double v) {
    return Eigen::Vector2d(0.6 * u, 0.6 * v);
  };
  double blur_px = 0.7;   ///< Standard deviation of a Gaussian, in projector pixels.
  double ambient = 0.03;  ///< Same scale as in Photo.
  double noise = 0.004;   ///< Standard deviation, as in Photo.
  int codes = 255;        ///< Maximum code of the camera; 0: not quantised.
  /// Direct light at a camera pixel, as in Photo, when the projector is white.
  std::function<double(int u, int v)> direct = [](int, int) { return 0.6; };
  /// Indirect light from other walls, relative to the mean of the half of the picture opposite to the pixel.
  std::function<double(int u, int v)> global = [](int, int) { return 0.0; };
  /// Other changes of a pixel's light in photograph number i, as by a passer-by.
  std::function<double(int u, int v, std::size_t i, double light)> disturbance = [](int, int, std::size_t,
                                                                                    double light) { return light; };

  [[nodiscard]] Eigen::Vector2d truth(int u, int v) const { return projector_pixel_at(u + 0.5, v + 0.5); }

  [[nodiscard]] structured_light::Photo photograph(const structured_light::PatternSet& set, std::size_t number) const {
    const structured_light::PatternPicture& picture = set.pictures.at(number);
    const bool is_columns = picture.axis == structured_light::PatternAxis::kColumns;
    const int extent = is_columns ? set.width_px : set.height_px;
    const Profile profile(set, picture, extent, blur_px);
    structured_light::Photo photo(camera_width_px, camera_height_px);
    // A table, read in a different order for every photograph: a camera of 20 megapixels needs a billion of these
    // values.
    const std::vector<float>& errors = normal_errors();
    auto place_in_table = static_cast<std::uint32_t>(7919 * (number + 1));
    for (int v = 0; v < camera_height_px; ++v) {
      for (int u = 0; u < camera_width_px; ++u) {
        place_in_table = 1664525U * place_in_table + 1013904223U;
        const Eigen::Vector2d position = truth(u, v);
        const bool is_on =
            position.x() >= 0.0 && position.x() < set.width_px && position.y() >= 0.0 && position.y() < set.height_px;
        const double at = is_columns ? position.x() : position.y();
        double light = ambient + (is_on ? direct(u, v) * profile.at(at) : 0.0);
        light += global(u, v) * profile.mean_of_half(at < 0.5 * extent);
        light = disturbance(u, v, number, light) +
                noise * static_cast<double>(errors[(place_in_table >> 12) % errors.size()]);
        light = std::clamp(light, 0.0, 1.0);
        *photo.at(u, v) = static_cast<float>(codes > 0 ? std::round(light * codes) / codes : light);
      }
    }
    return photo;
  }

  [[nodiscard]] structured_light::Decoder decoder(const structured_light::PatternSet& set,
                                                  const structured_light::DecodeSettings& settings = {}) const {
    auto decoder = structured_light::Decoder::from(set, settings, camera_width_px, camera_height_px);
    CHECK(decoder.has_value());
    for (std::size_t i = 0; i < set.pictures.size(); ++i) CHECK(decoder->add(photograph(set, i)).has_value());
    return *std::move(decoder);
  }

 private:
  static const std::vector<float>& normal_errors() {
    static const std::vector<float> errors = [] {
      std::mt19937 random(1);
      std::normal_distribution<float> error(0.0f, 1.0f);
      std::vector<float> values(1 << 16);
      for (float& value : values) value = error(random);
      return values;
    }();
    return errors;
  }

  /// One line across a picture's stripes, blurred, with eight values per pixel.
  class Profile {
   public:
    Profile(const structured_light::PatternSet& set, const structured_light::PatternPicture& picture, int extent,
            double blur_px)
        : extent_(extent) {
      std::vector<double> sharp(static_cast<std::size_t>(extent * kFine));
      for (int i = 0; i < extent * kFine; ++i) {
        const int position = i / kFine;
        const bool is_columns = picture.axis == structured_light::PatternAxis::kColumns;
        sharp[static_cast<std::size_t>(i)] =
            structured_light::level_at(set, picture, is_columns ? position : 0, is_columns ? 0 : position);
        half_means_[i < extent * kFine / 2 ? 0 : 1] += 2.0 * sharp[static_cast<std::size_t>(i)] / (extent * kFine);
      }
      const int reach = static_cast<int>(std::ceil(4.0 * blur_px * kFine));
      values_.resize(sharp.size());
      for (int i = 0; i < extent * kFine; ++i) {
        double sum = 0.0;
        double weights = 0.0;
        for (int k = -reach; k <= reach; ++k) {
          const double weight = blur_px > 0.0 ? std::exp(-0.5 * std::pow(k / (blur_px * kFine), 2)) : 1.0;
          weights += weight;
          if (i + k >= 0 && i + k < extent * kFine) sum += weight * sharp[static_cast<std::size_t>(i + k)];
        }
        values_[static_cast<std::size_t>(i)] = sum / weights;
      }
    }
    [[nodiscard]] double at(double position) const {
      const double fine = std::clamp(position * kFine - 0.5, 0.0, static_cast<double>(extent_ * kFine - 1));
      const auto i = std::min(static_cast<std::size_t>(fine), values_.size() - 1);
      const double share = fine - static_cast<double>(i);
      return (1.0 - share) * values_[i] + share * values_[std::min(i + 1, values_.size() - 1)];
    }
    [[nodiscard]] double mean_of_half(bool second) const { return half_means_[second ? 1 : 0]; }

   private:
    static constexpr int kFine = 8;
    int extent_;
    std::vector<double> values_;
    double half_means_[2] = {0.0, 0.0};
  };
};

/// Distances of decoded positions from a wall's truth.
struct WallErrors {
  int decoded = 0;
  int gross = 0;  ///< Farther than 2 pixels.
  double median_px = 0.0;
  double worst_px = 0.0;
  double mean_square_of_sigmas = 0.0;  ///< Mean square of errors in units of their sigmas; 1 if the sigmas are correct.
};

inline WallErrors errors_of(const LitWall& wall, const structured_light::Decoded& decoded) {
  WallErrors errors;
  std::vector<double> distances;
  for (int v = 0; v < decoded.fate.height(); ++v) {
    for (int u = 0; u < decoded.fate.width(); ++u) {
      const float* const position = decoded.position_px.at(u, v);
      const float* const sigma = decoded.sigma_px.at(u, v);
      CHECK(std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(sigma[0]) &&
            std::isfinite(sigma[1]));
      if (*decoded.fate.at(u, v) != structured_light::PixelFate::kDecoded) continue;
      const Eigen::Vector2d off = Eigen::Vector2d(position[0], position[1]) - wall.truth(u, v);
      distances.push_back(off.norm());
      errors.gross += off.norm() > 2.0 ? 1 : 0;
      for (int a = 0; a < 2; ++a)
        errors.mean_square_of_sigmas += 0.5 * std::pow(off[a] / static_cast<double>(sigma[a]), 2);
    }
  }
  if (distances.empty()) return errors;
  errors.decoded = static_cast<int>(distances.size());
  errors.mean_square_of_sigmas /= errors.decoded;
  std::sort(distances.begin(), distances.end());
  errors.median_px = distances[distances.size() / 2];
  errors.worst_px = distances.back();
  return errors;
}

}  // namespace cyclorama
