// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/temporal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama {
namespace {

constexpr double kExactPx = 1e-6;    ///< A shift that is this near to whole pixels is one: angles are sums of doubles.
constexpr float kSameNormal = 0.9f;  ///< Cosine.
/// How many pixels' worth of a slanted surface two distances may differ: half a pixel of interpolation, and half of the
/// samples' place in each pixel.
constexpr double kSameFootprints = 2.0;
constexpr double kLeastCosine = 0.05;
constexpr float kBoxDeviations = 1.5f;
constexpr float kLeastShare = 0.25f;  ///< Of the four pixels around, that must show the surface.

using Colour = Eigen::Array3f;

float luminance_of(const Colour& c) { return 0.2126f * c.x() + 0.7152f * c.y() + 0.0722f * c.z(); }

Colour colour_at(const RadianceImage& image, int x, int y) { return Eigen::Map<const Colour>(image.at(x, y)); }

/// Means over samples.
struct Past {
  Colour radiance = Colour::Zero();
  float square = 0.0f;
  float samples = 0.0f;
  Colour albedo = Colour::Zero();
  Colour normal = Colour::Zero();
  float distance = 0.0f;
};

/// The same surface, seen now at `expected` metres.
bool is_same(const Film& now, int x, int y, const Film& before, int from_x, int from_y, double expected, double cosine,
             double radians_per_px) {
  const float distance = *before.features.distance.at(from_x, from_y);
  const bool surface = *now.features.distance.at(x, y) > 0.0f;
  if (surface != (distance > 0.0f)) return false;
  if (!surface) return true;
  const Colour normal = colour_at(now.features.normal, x, y);
  const Colour other = colour_at(before.features.normal, from_x, from_y);
  const float alike = (normal * other).sum();
  if (!(alike > kSameNormal * std::sqrt((normal * normal).sum() * (other * other).sum()))) return false;
  const double most = kSameFootprints * expected * radians_per_px / std::max(kLeastCosine, cosine);
  return std::fabs(static_cast<double>(distance) - expected) <= most;
}

/// What of the past is at a place, in pixels of its film.
class Lookup {
 public:
  /// `same_pixels`: those of before are those of now, whatever surface their samples met at an edge.
  Lookup(const Film& now, const Film& before, double radians_per_px, bool same_pixels)
      : now_(now), before_(before), radians_per_px_(radians_per_px), same_pixels_(same_pixels) {}

  /// For pixel (x, y) of now. Interpolated between the pixels around `place` that show the same surface.
  [[nodiscard]] Past at(int x, int y, PanoramaPixel place, double expected, double cosine) const {
    const double u = place.u - 0.5;
    const double v = place.v - 0.5;
    Past past;
    if (!(u > -1.0 && v > -1.0 && u < before_.width() && v < before_.height())) return past;
    const int left = static_cast<int>(std::floor(u));
    const int top = static_cast<int>(std::floor(v));
    float share = 0.0f;
    for (int i = 0; i < 4; ++i) {
      const int from_x = left + i % 2;
      const int from_y = top + i / 2;
      const double across = i % 2 == 0 ? 1.0 - (u - left) : u - left;
      const double down = i / 2 == 0 ? 1.0 - (v - top) : v - top;
      const auto weight = static_cast<float>(across * down);
      if (weight == 0.0f || from_x < 0 || from_y < 0 || from_x >= before_.width() || from_y >= before_.height())
        continue;
      if (*before_.samples.at(from_x, from_y) == 0) continue;
      if (!same_pixels_ && !is_same(now_, x, y, before_, from_x, from_y, expected, cosine, radians_per_px_)) continue;
      share += weight;
      add(from_x, from_y, weight, &past);
    }
    if (share < kLeastShare) return {};
    for (Colour* const mean : {&past.radiance, &past.albedo, &past.normal}) *mean /= share;
    past.square /= share;
    past.samples /= share;
    past.distance /= share;
    return past;
  }

 private:
  void add(int x, int y, float weight, Past* past) const {
    const auto samples = static_cast<float>(*before_.samples.at(x, y));
    past->radiance += weight / samples * colour_at(before_.sum, x, y);
    past->square += weight / samples * *before_.square.at(x, y);
    past->samples += weight * samples;
    past->albedo += weight * colour_at(before_.features.albedo, x, y);
    past->normal += weight * colour_at(before_.features.normal, x, y);
    past->distance += weight * *before_.features.distance.at(x, y);
  }

  const Film& now_;
  const Film& before_;
  double radians_per_px_;
  bool same_pixels_;
};

/// Takes the past into the range of the colours around the pixel now.
void clamp_to_now(const RadianceImage& now, int x, int y, Past* past) {
  Colour sum = Colour::Zero();
  Colour square = Colour::Zero();
  float count = 0.0f;
  for (int row = std::max(0, y - 1); row <= std::min(now.height() - 1, y + 1); ++row) {
    for (int column = std::max(0, x - 1); column <= std::min(now.width() - 1, x + 1); ++column) {
      const Colour colour = colour_at(now, column, row);
      sum += colour;
      square += colour * colour;
      count += 1.0f;
    }
  }
  const Colour mean = sum / count;
  const Colour half = kBoxDeviations * (square / count - mean * mean).max(0.0f).sqrt();
  const Colour clamped = past->radiance.max(mean - half).min(mean + half);
  const float moved = (clamped - past->radiance).abs().maxCoeff();
  if (moved == 0.0f) return;
  past->samples *= half.maxCoeff() / (half.maxCoeff() + moved);
  const float before = luminance_of(past->radiance);
  const float after = luminance_of(clamped);
  past->square = std::max(0.0f, past->square - before * before) + after * after;
  past->radiance = clamped;
}

void add_to(Film* film, int x, int y, const Past& past) {
  const auto more = static_cast<std::int32_t>(std::lround(past.samples));
  if (more == 0) return;
  std::int32_t& samples = *film->samples.at(x, y);
  const auto m = static_cast<float>(more);
  const float share = m / (m + static_cast<float>(samples));
  Eigen::Map<Colour> sum(film->sum.at(x, y));
  sum += m * past.radiance;
  *film->square.at(x, y) += m * past.square;
  Eigen::Map<Colour> albedo(film->features.albedo.at(x, y));
  Eigen::Map<Colour> normal(film->features.normal.at(x, y));
  albedo += share * (past.albedo - albedo);
  normal += share * (past.normal - normal);
  float& distance = *film->features.distance.at(x, y);
  distance += share * (past.distance - distance);
  samples += more;
}

/// From now's pixels to those of the film before.
class Reprojection {
 public:
  Reprojection(const FilmView& now, const FilmView& before) : now_(now), before_(before) {
    still_ = now.eye == before.eye && now.panorama == before.panorama;
    turn_rad_ = wrapped_angle(now.heading_rad - before.heading_rad);
    shift_px_ = turn_rad_ / now.panorama.radians_per_px();
    if (std::fabs(shift_px_ - std::round(shift_px_)) < kExactPx) shift_px_ = std::round(shift_px_);
  }
  [[nodiscard]] bool eye_stayed() const { return still_; }
  [[nodiscard]] bool same_pixels() const { return still_ && shift_px_ == std::round(shift_px_); }

  struct Place {
    PanoramaPixel pixel;                                    ///< Of the film before.
    double distance = 0.0;                                  ///< From the eye before.
    Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< From the eye now; as the normals'.
  };
  /// `distance` 0 is at infinity.
  [[nodiscard]] Place of(int x, int y, double distance) const {
    const PanoramaPixel pixel{now_.rect.x + x + 0.5, now_.rect.y + y + 0.5};
    const Eigen::Vector3d looks = turned(now_.panorama.direction_at(pixel), now_.heading_rad).normalized();
    Place place{{pixel.u + shift_px_, pixel.v}, distance, looks};
    if (!still_) {
      Eigen::Vector3d from_before = looks;
      if (distance > 0.0) {
        from_before = distance * looks + (now_.eye - before_.eye);
        place.distance = from_before.norm();
      }
      place.pixel = before_.panorama.pixel_of(turned(from_before, -before_.heading_rad));
    }
    place.pixel.u -= before_.rect.x;
    place.pixel.v -= before_.rect.y;
    return place;
  }

 private:
  /// To the right.
  static Eigen::Vector3d turned(const Eigen::Vector3d& v, double angle_rad) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    return {c * v.x() - s * v.z(), v.y(), s * v.x() + c * v.z()};
  }

  const FilmView& now_;
  const FilmView& before_;
  bool still_ = false;
  double turn_rad_ = 0.0;
  double shift_px_ = 0.0;
};

}  // namespace

Film TemporalHistory::accumulate(Film film, const FilmView& view) {
  CHECK(film.width() == view.rect.width && film.height() == view.rect.height && !film.features.albedo.empty());
  if (past_) {
    const Reprojection reprojection(view, past_->view);
    const Film now = film;
    const RadianceImage means = now.mean();
    const Lookup lookup(now, past_->film, view.panorama.radians_per_px(), reprojection.same_pixels());
    for (int y = 0; y < film.height(); ++y) {
      for (int x = 0; x < film.width(); ++x) {
        const auto place = reprojection.of(x, y, static_cast<double>(*now.features.distance.at(x, y)));
        const Eigen::Vector3d normal = colour_at(now.features.normal, x, y).matrix().cast<double>();
        Past past = lookup.at(x, y, place.pixel, place.distance, std::fabs(normal.dot(place.direction)));
        if (past.samples == 0.0f) continue;
        if (!reprojection.eye_stayed()) {
          clamp_to_now(means, x, y, &past);
          past.samples = std::min(past.samples, static_cast<float>(most_samples_));
        }
        add_to(&film, x, y, past);
      }
    }
  }
  past_ = {film, view};
  return film;
}

}  // namespace cyclorama
