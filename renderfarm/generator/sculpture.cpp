// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/sculpture.h"

namespace cyclorama::generator {
namespace {

/// A ray from a position on the axis.
struct Outlook {
  Vec3 origin;
  Vec3 direction;
};

class Grid {
 public:
  explicit Grid(const Sculpture& s)
      : from_(s.from), axis_(s.to - s.from), along_(axis_.normalized()), focus_(s.front_focus) {
    front_ = (s.front - s.front.dot(along_) * along_).normalized();
    side_ = along_.cross(front_);
    cap_ = 0.25f * s.girth * s.ends;
    height_ = axis_.norm() + 2.0f * cap_;
  }

  [[nodiscard]] float height() const { return height_; }

  [[nodiscard]] Outlook at(float u, float v) const {
    const float turn = 2.0f * kPi * (u - 0.5f);
    const float angle = turn - focus_ * std::sin(turn);
    const Vec3 around = std::cos(angle) * front_ + std::sin(angle) * side_;
    // The angle ends short of the poles, where a grid has no normal.
    constexpr float kPole = 0.497f * kPi;
    const float at = v * height_;
    if (at < cap_) return {from_, tilted(around, -kPole * (1.0f - at / cap_))};
    const float beyond = at - (height_ - cap_);
    if (beyond > 0.0f) return {from_ + axis_, tilted(around, kPole * beyond / cap_)};
    return {from_ + (at - cap_) * along_, around};
  }

 private:
  [[nodiscard]] Vec3 tilted(const Vec3& around, float elevation) const {
    return std::cos(elevation) * around + std::sin(elevation) * along_;
  }

  Vec3 from_;
  Vec3 axis_;
  Vec3 along_;
  Vec3 front_;
  Vec3 side_;
  float focus_;
  float cap_;
  float height_;
};

/// Returns the distance of the outermost surface along a ray, found by steps from outside towards the axis.
float outermost(const Sculpture& s, const Outlook& look) {
  constexpr int kMaxSteps = 48;
  const float close = 2e-4f * s.reach;
  float t = s.reach;
  for (int i = 0; i < kMaxSteps; ++i) {
    const float gap = s.distance(look.origin + t * look.direction);
    if (gap < close) break;
    t -= 0.92f * gap;
    if (t < close) return close;
  }
  return t;
}

}  // namespace

Pose standing_at(const Vec3& position, float heading, float scale) {
  return {position, Eigen::AngleAxisf(heading, Vec3::UnitY()).toRotationMatrix(), scale};
}

Patch wrapped(const Sculpture& sculpture, const Pose& pose, float density) {
  const Grid grid(sculpture);
  Patch patch;
  patch.width_m = sculpture.girth * pose.scale;
  patch.height_m = grid.height() * pose.scale;
  patch.density = density;
  patch.closed = true;
  patch.at = [sculpture, pose, grid](float u, float v, float spacing) {
    const Outlook look = grid.at(u, v);
    const Vec3 p = look.origin + outermost(sculpture, look) * look.direction;
    const float relief = sculpture.relief ? sculpture.relief(p, spacing / pose.scale) : 0.0f;
    return Surfel{pose.to_room(p + relief * look.direction), sculpture.colour(p, spacing / pose.scale)};
  };
  turn_towards(patch, pose.to_room(0.5f * (sculpture.from + sculpture.to)), true);
  return patch;
}

}  // namespace cyclorama::generator
