// SPDX-License-Identifier: Apache-2.0
/// Light that bounces more than once between the facets of rough glass. It leaves as a wide lobe on both sides, so that
/// rough glass under uniform illumination is as bright as clear glass. Source: Kulla and Conty 2017, for dielectrics.
#pragma once

#include <optional>

#include "renderfarm/render/bsdf/interface.h"

namespace cyclorama::render {

/// The wide lobe of rough glass for one viewing direction. Thread-bound.
class WideGlass {
 public:
  WideGlass(const Bsdf& bsdf, const OpaqueBase& base, const Interface& interface, float cos_o)
      : base_(base), inside_(bsdf.inside) {
    if (!interface.passes() || interface.is_straight() || !(bsdf.alpha > 0.0f)) return;
    if (!interface.is_body()) {
      const float lost = base.bounce(cos_o).lost;
      const Vec3 passed = interface.passing() * (1.0f - base.gloss_more());
      down_albedo_ = passed * lost;
      down_ = passed * share(lost, base.mean_bounce().lost);
      return;
    }
    glass_.emplace(bsdf.alpha, bsdf.ior);
    const float lost = glass_->at(cos_o, inside_);
    const float here = glass_->mean(inside_);
    const float there = glass_->mean(!inside_);
    if (!(here > 0.0f) || !(there > 0.0f)) return;
    // This distribution makes the lobe reciprocal, except for the square of the index of refraction.
    const float eta2 = interface.eta() * interface.eta();
    const float passed = eta2 * there / (here + eta2 * there);
    up_albedo_ = interface.part() * (1.0f - passed) * lost;
    up_ = up_albedo_ / here;
    down_albedo_ = interface.passing() * (passed * lost);
    down_ = down_albedo_ / there;
  }

  /// Returns BSDF times pi, without the cosine, which is `cos_i` > 0.
  [[nodiscard]] float up(float cos_i) const { return glass_ ? up_ * glass_->at(cos_i, inside_) : 0.0f; }
  [[nodiscard]] Vec3 down(float cos_i) const {
    if (glass_) return down_ * glass_->at(cos_i, !inside_);
    return down_albedo_.isZero(0.0f) ? Vec3(Vec3::Zero()) : Vec3(down_ * base_.bounce(cos_i).lost);
  }
  [[nodiscard]] float up_albedo() const { return up_albedo_; }
  [[nodiscard]] const Vec3& down_albedo() const { return down_albedo_; }
  /// Returns the albedo of a single bounce.
  [[nodiscard]] float once(float cos_o) const { return glass_ ? 1.0f - glass_->at(cos_o, inside_) : 1.0f; }

 private:
  const OpaqueBase& base_;
  bool inside_;
  std::optional<GlassLoss> glass_;
  float up_ = 0.0f;
  float up_albedo_ = 0.0f;
  Vec3 down_ = Vec3::Zero();
  Vec3 down_albedo_ = Vec3::Zero();
};

}  // namespace cyclorama::render
