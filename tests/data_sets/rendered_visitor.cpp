// SPDX-License-Identifier: Apache-2.0
#include "tests/data_sets/rendered_visitor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace cyclorama {
namespace {

using Eigen::Vector3d;

constexpr double kFloorM = 1.4;
constexpr int kSamples = 2;  // Per pixel and dimension.

enum class Cloth { kSkin, kHead, kShirt, kTrousers };

struct Capsule {
  Vector3d a, b;
  double radius;
  Cloth cloth;
};

std::vector<Capsule> body_of(const RenderedVisitor& visitor) {
  const double h = visitor.height_m;
  const Vector3d hip(visitor.x_m, kFloorM - 0.53 * h, visitor.depth_m);
  // Everything above the hips rotates about them.
  const double c = std::cos(visitor.lean_rad), s = std::sin(visitor.lean_rad);
  const auto upper = [&](double right, double up, double near = 0.0) {
    const double x = -right;
    return Vector3d(hip.x() + c * x - s * up, hip.y() - c * up - s * x, hip.z() - near);
  };
  const auto lower = [&](double x, double up) { return Vector3d(hip.x() + x, hip.y() - up, hip.z()); };
  std::vector<Capsule> body;
  for (const double side : {-1.0, 1.0}) {
    body.push_back({lower(0.05 * h * side, 0.0), lower(0.06 * h * side, -0.48 * h), 0.042 * h, Cloth::kTrousers});
    body.push_back({upper(0.045 * h * side, 0.0), upper(0.055 * h * side, 0.23 * h), 0.065 * h, Cloth::kShirt});
    const Vector3d shoulder = upper(0.112 * h * side, 0.275 * h);
    const double reach = 0.17 * h;
    const Vector3d elbow =
        shoulder + Vector3d(-side * reach * std::sin(visitor.arms_rad), reach * std::cos(visitor.arms_rad), 0);
    const Vector3d hand = elbow + Vector3d(-0.5 * side * reach * std::sin(visitor.arms_rad), reach, -0.05);
    body.push_back({shoulder, elbow, 0.027 * h, Cloth::kShirt});
    body.push_back({elbow, hand, 0.022 * h, Cloth::kSkin});
    body.push_back({upper(0.0, 0.285 * h), shoulder, 0.033 * h, Cloth::kShirt});
  }
  body.push_back({upper(0.0, 0.28 * h), upper(0.0, 0.38 * h), 0.033 * h, Cloth::kSkin});
  const double crown = 0.47 * h, r = 0.5 * visitor.head_m;
  body.push_back({upper(0.0, crown - 0.225 + r), upper(0.0, crown - r), r, Cloth::kHead});
  return body;
}

/// Distance along `ray` (of length 1) from the lens; infinite if it misses.
double distance_to(const Capsule& capsule, const Vector3d& ray) {
  const double kNever = std::numeric_limits<double>::infinity();
  const Vector3d axis = capsule.b - capsule.a;
  const double length2 = axis.squaredNorm(), along = axis.dot(ray), from = -axis.dot(capsule.a);
  const double qa = length2 - along * along;
  const double qb = -length2 * ray.dot(capsule.a) - from * along;
  const double qc = length2 * (capsule.a.squaredNorm() - capsule.radius * capsule.radius) - from * from;
  const double root = qb * qb - qa * qc;
  if (root >= 0.0 && qa > 1e-12) {
    const double t = (-qb - std::sqrt(root)) / qa;
    const double at = from + t * along;
    if (at >= 0.0 && at <= length2) return t > 0.0 ? t : kNever;
  }
  double nearest = kNever;
  for (const Vector3d& end : {capsule.a, capsule.b}) {
    const double b = ray.dot(end), inside = b * b - end.squaredNorm() + capsule.radius * capsule.radius;
    if (inside >= 0.0 && b - std::sqrt(inside) > 0.0) nearest = std::min(nearest, b - std::sqrt(inside));
  }
  return nearest;
}

float grey_of(const RenderedVisitor& visitor, const Capsule& capsule, const Vector3d& position) {
  const Vector3d axis = capsule.b - capsule.a;
  const double u = std::clamp((position - capsule.a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  const Vector3d normal = (position - capsule.a - u * axis).normalized();
  const double lit = 0.62 + 0.38 * std::max(0.0, normal.dot(Vector3d(-0.35, -0.6, -0.72).normalized()));
  double grey = 90.0;
  switch (capsule.cloth) {
    case Cloth::kSkin:
      grey = visitor.skin_grey;
      break;
    case Cloth::kHead:
      // Hair on top and at the sides, a face between.
      grey = u > 0.75 || std::abs(normal.x()) > 0.8
                 ? visitor.hair_grey
                 : visitor.skin_grey * (1.0 - 0.25 * (std::sin(40.0 * position.y()) > 0.8));
      break;
    case Cloth::kShirt:
      grey =
          visitor.shirt_grey * (1.0 + 0.35 * std::sin(70.0 * (position.y() - visitor.depth_m) + visitor.pattern_phase));
      break;
    case Cloth::kTrousers:
      grey = 45.0;
      break;
  }
  return static_cast<float>(lit * grey);
}

void paint(const RenderedVisitor& visitor, const Pinhole& lens, Image<float, 1>* picture, Image<float, 1>* depth) {
  for (const Capsule& capsule : body_of(visitor)) {
    const auto a = lens.pixel_of(capsule.a), b = lens.pixel_of(capsule.b);
    if (!a || !b) continue;
    const double margin =
        1.3 * capsule.radius * lens.focal_px / std::max(0.1, std::min(capsule.a.z(), capsule.b.z())) + 2.0;
    const int left = std::max(0, static_cast<int>(std::min(a->x(), b->x()) - margin));
    const int right = std::min(lens.width_px, static_cast<int>(std::max(a->x(), b->x()) + margin));
    const int top = std::max(0, static_cast<int>(std::min(a->y(), b->y()) - margin));
    const int bottom = std::min(lens.height_px, static_cast<int>(std::max(a->y(), b->y()) + margin));
    for (int v = kSamples * top; v < kSamples * bottom; ++v) {
      for (int u = kSamples * left; u < kSamples * right; ++u) {
        const Vector3d ray = lens.direction_at((u + 0.5) / kSamples, (v + 0.5) / kSamples).normalized();
        const double t = distance_to(capsule, ray);
        if (!(t < double{*depth->at(u, v)})) continue;
        *depth->at(u, v) = static_cast<float>(t);
        *picture->at(u, v) = grey_of(visitor, capsule, t * ray);
      }
    }
  }
}

Image<float, 1> furnished(const Pinhole& lens, std::uint32_t seed) {
  Image<float, 1> room(lens.width_px, lens.height_px);
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int y = 0; y < room.height(); ++y) {
    for (int x = 0; x < room.width(); ++x) {
      const double across = (x + 0.5) / room.width(), down = (y + 0.5) / room.height();
      const double wall = down < 0.78 ? 105.0 : 75.0;
      *room.at(x, y) = static_cast<float>(wall * (1.25 - 0.4 * across - 0.2 * down) +
                                          6.0 * std::sin(37.0 * across) * std::sin(29.0 * down));
    }
  }
  for (int i = 0; i < 25; ++i) {
    const int left = static_cast<int>(uniform() * room.width()), top = static_cast<int>(uniform() * room.height());
    const int right = std::min(room.width(), left + 3 + static_cast<int>(0.15 * uniform() * room.width()));
    const int bottom = std::min(room.height(), top + 3 + static_cast<int>(0.2 * uniform() * room.height()));
    const auto grey = static_cast<float>(30.0 + 170.0 * uniform());
    for (int y = top; y < bottom; ++y) std::fill(room.at(left, y), room.at(left, y) + (right - left), grey);
  }
  return room;
}

}  // namespace

VisitorRoom::VisitorRoom(const Pinhole& lens, std::uint32_t seed, double noise_grey)
    : lens_(lens), room_(furnished(lens, seed)), sensor_(noise_grey, seed) {}

GreyImage VisitorRoom::picture(const std::vector<RenderedVisitor>& visitors, const RenderedLight& light,
                               std::uint64_t number) const {
  const int width = lens_.width_px, height = lens_.height_px;
  Image<float, 1> fine(kSamples * width, kSamples * height, -1.0f);
  Image<float, 1> depth(kSamples * width, kSamples * height, std::numeric_limits<float>::infinity());
  for (const RenderedVisitor& visitor : visitors) paint(visitor, lens_, &fine, &depth);
  Image<float, 1> lit(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0.0f;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const float grey = *fine.at(kSamples * x + i % kSamples, kSamples * y + i / kSamples);
        sum += grey < 0.0f ? *room_.at(x, y) : grey;
      }
      const double du = (x + 0.5) / width - light.lamp_u, dv = (y + 0.5) / height - light.lamp_v;
      const double gain = light.gain * (1.0 + light.lamp * std::exp(-(du * du + dv * dv) / 0.18));
      *lit.at(x, y) = static_cast<float>(gain) * sum / (kSamples * kSamples);
    }
  }
  return sensor_.expose(lit, 1.0, number);
}

}  // namespace cyclorama
