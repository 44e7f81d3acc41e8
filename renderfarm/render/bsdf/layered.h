// SPDX-License-Identifier: Apache-2.0
/// Scattering of general surfaces: a clear coat over a surface that reflects, scatters and transmits light.
#pragma once

#include <numeric>

#include "renderfarm/render/bsdf/coat.h"
#include "renderfarm/render/bsdf/interface.h"
#include "renderfarm/render/bsdf/scattering.h"
#include "renderfarm/render/bsdf/wide_glass.h"

namespace cyclorama::render {

template <>
class Scattering<SurfaceLevel::kLayered> {
 public:
  Scattering(const Bsdf& bsdf, const Vec3& normal, const Vec3& wo)
      : frame_(normal),
        wo_(seen_from_above(frame_.to_local(wo))),
        mirror_(!(bsdf.alpha > 0.0f)),
        facets_(bsdf.alpha, wo_),
        grazing_(bsdf.alpha),
        base_(bsdf, wo_.z(), opaque_dielectric(bsdf), (1.0f - bsdf.metallic) * (1.0f - bsdf.transmission)),
        interface_(bsdf, base_),
        wide_(bsdf, base_, interface_, wo_.z()),
        coat_(bsdf, normal, wo) {
    if (coat_.part() > 0.0f && !mirror_) {
      // A rough coat reflects more evenly than a smooth one; the factor fits measurements of white metals with lobes of
      // all widths.
      const float part = coat_.part() * (1.0f - std::sqrt(bsdf.coat_alpha));
      const float seen = base_.bounce(wo_.z()).darker * part;
      under_coat_ = base_.mean_facet() * share(seen, base_.mean_bounce().darker);
      under_coat_albedo_ = base_.mean_facet() * seen;
    }
    // Bounded sampling would miss some facets that transmit light.
    bounded_ = !interface_.passes() || interface_.is_straight();
    chances_[kCoat] = coat_.albedo();
    chances_[kFacets] = luminance(facets_albedo()) * coat_.left();
    chances_[kDiffuse] = luminance(base_.diffuse_albedo()) * coat_.left();
    chances_[kUp] = (luminance(base_.more_albedo()) + wide_.up_albedo()) * coat_.left() + luminance(under_coat_albedo_);
    chances_[kDown] = luminance(wide_.down_albedo()) * coat_.left();
    chances_[kStraight] = interface_.is_straight() ? luminance(interface_.passing()) * coat_.left() : 0.0f;
    const float sum = std::accumulate(chances_.begin(), chances_.end(), 0.0f);
    for (float& chance : chances_) chance = sum > 0.0f ? chance / sum : 0.0f;
  }

  // It cannot be copied or moved, because its parts refer to each other.
  Scattering(const Scattering&) = delete;
  Scattering& operator=(const Scattering&) = delete;

  [[nodiscard]] Vec3 evaluate(const Vec3& wi) const { return evaluate(frame_.to_local(wi), wi); }
  [[nodiscard]] float pdf(const Vec3& wi) const { return pdf(frame_.to_local(wi), wi); }

  [[nodiscard]] ScatterSample sample(const Vec2& u, float choice) const {
    int lobe = 0;
    while (lobe < kLobes - 1 && choice >= chances_[static_cast<std::size_t>(lobe)]) {
      choice -= chances_[static_cast<std::size_t>(lobe++)];
    }
    const float chance = chances_[static_cast<std::size_t>(lobe)];
    ScatterSample sample;
    if (!(chance > 0.0f)) return sample;
    switch (lobe) {
      case kCoat:
        return sample_coat(u, chance);
      case kFacets:
        return sample_facets(u, std::min(choice / chance, 1.0f), chance);
      case kStraight:
        sample.wi = frame_.from_local(-wo_);
        sample.weight = interface_.passing() * (coat_.crossed(sample.wi) / chance);
        sample.through = true;
        return sample;
      default:
        break;
    }
    Vec3 wi = lobe == kDiffuse ? cosine_hemisphere(u) : grazing_.sample(u);
    if (lobe == kDown) wi.z() = -wi.z();
    return weighed(wi, frame_.from_local(wi));
  }

  /// Returns the share of the light from directly behind the surface that reaches the viewer without a change of
  /// direction; excludes light that a rough or refracting surface transmits.
  [[nodiscard]] Vec3 straight() const {
    if (!interface_.passes()) return Vec3::Zero();
    const Vec3 wi = frame_.from_local(-wo_);
    if (interface_.is_straight()) return interface_.passing() * coat_.crossed(wi);
    if (!mirror_ || interface_.is_body()) return Vec3::Zero();
    return interface_.at(wo_.z()).passed * coat_.narrow(wi);
  }

  [[nodiscard]] Vec3 albedo() const {
    Vec3 sum = base_.more_albedo() + base_.diffuse_albedo() + Vec3::Constant(wide_.up_albedo()) + wide_.down_albedo() +
               facets_albedo();
    if (interface_.is_straight()) sum += interface_.passing();
    return sum * coat_.left() + Vec3::Constant(coat_.albedo());
  }

 private:
  enum Lobe { kCoat, kFacets, kDiffuse, kUp, kDown, kStraight, kLobes };

  /// Returns the share of the surface that has the gloss of an opaque dielectric; bodies reflect light through
  /// Interface instead.
  [[nodiscard]] static float opaque_dielectric(const Bsdf& bsdf) {
    return (1.0f - bsdf.metallic) * (bsdf.thin ? 1.0f : 1.0f - bsdf.transmission);
  }

  /// Returns the albedo of a single bounce off the facets or a single pass through them, under uniform illumination.
  [[nodiscard]] Vec3 facets_albedo() const {
    Vec3 albedo = base_.gloss_albedo();
    if (!interface_.passes() || interface_.is_straight()) return albedo;
    if (!interface_.is_body()) {
      const BounceAlbedo bounce = base_.bounce(wo_.z());
      return albedo + interface_.passing() * std::max(0.0f, bounce.low + bounce.high - base_.gloss_once(bounce));
    }
    const FacetShare share = interface_.at(wo_.z());
    const Vec3 glass = share.mirrored - base_.facet(wo_.z()) + share.passed;
    return albedo + glass * wide_.once(wo_.z());
  }

  [[nodiscard]] Vec3 evaluate(const Vec3& local, const Vec3& wi) const {
    const float cosine = std::abs(local.z());
    if (local.z() > 0.0f) {
      Vec3 wide = base_.wide(cosine);
      wide.array() += wide_.up(cosine);
      wide *= coat_.wide(wi);
      if (coat_.part() > 0.0f) wide += under_coat_ * base_.bounce(cosine).darker;
      Vec3 sum = wide * (cosine / kPi);
      sum.array() += coat_.evaluate(wi);
      if (mirror_) return sum;
      const Vec3 h = normalized_or(wo_ + local, Vec3::UnitZ());
      const float lobe = facets_.pdf(h) * facets_.visibility(cosine) * cosine;
      return sum + interface_.at(local.dot(h)).mirrored * (lobe * coat_.narrow(wi));
    }
    if (!(local.z() < 0.0f) || !interface_.passes()) return Vec3::Zero();
    const bool body = interface_.is_body();
    Vec3 sum = wide_.down(cosine) * ((body ? coat_.crossed(wi) : coat_.wide(wi)) * cosine / kPi);
    if (mirror_ || interface_.is_straight()) return sum;
    const FacetTurn turn = interface_.turn(wo_, local);
    if (!(turn.jacobian > 0.0f)) return sum;
    const float lobe = facets_.pdf(turn.h) * 4.0f * facets_.visibility(cosine) * turn.jacobian * turn.o_h * cosine;
    return sum + interface_.at(turn.o_h).passed * (lobe * (body ? coat_.crossed(wi) : coat_.narrow(wi)));
  }

  [[nodiscard]] float pdf(const Vec3& local, const Vec3& wi) const {
    const float grazing = grazing_.pdf(std::abs(local.z()));
    if (local.z() > 0.0f) {
      const float wide = chances_[kDiffuse] * local.z() / kPi + chances_[kUp] * grazing;
      const float sum = wide + chances_[kCoat] * coat_.pdf(wi);
      if (mirror_) return sum;
      const Vec3 h = normalized_or(wo_ + local, Vec3::UnitZ());
      const float facets = facets_.reflected_pdf(facets_.pdf(h), bounded_);
      return sum + chances_[kFacets] * facets * interface_.at(local.dot(h)).mirror_chance();
    }
    if (!(local.z() < 0.0f) || !interface_.passes()) return 0.0f;
    const float sum = chances_[kDown] * grazing;
    if (mirror_ || interface_.is_straight()) return sum;
    const FacetTurn turn = interface_.turn(wo_, local);
    if (!(turn.jacobian > 0.0f)) return sum;
    const float facets = facets_.microfacet_pdf(facets_.pdf(turn.h), turn.o_h) * turn.jacobian;
    return sum + chances_[kFacets] * facets * (1.0f - interface_.at(turn.o_h).mirror_chance());
  }

  [[nodiscard]] ScatterSample weighed(const Vec3& local, const Vec3& wi) const {
    ScatterSample sample{wi, Vec3::Zero(), pdf(local, wi), local.z() < 0.0f};
    if (sample.pdf > 0.0f) sample.weight = evaluate(local, wi) / sample.pdf;
    return sample;
  }

  [[nodiscard]] ScatterSample sample_coat(const Vec2& u, float chance) const {
    const Vec3 wi = coat_.sample(u);
    const Vec3 local = frame_.to_local(wi);
    // The coat's own normal may point below the surface.
    if (!(local.z() > 0.0f)) return {wi, Vec3::Zero(), 0.0f, false};
    if (coat_.is_mirror()) return {wi, Vec3::Constant(coat_.mirrored() / chance), 0.0f, false};
    return weighed(local, wi);
  }

  [[nodiscard]] ScatterSample sample_facets(const Vec2& u, float choice, float chance) const {
    const Vec3 h = mirror_ ? Vec3(Vec3::UnitZ()) : facets_.sample(u, bounded_);
    const float o_h = wo_.dot(h);
    const FacetShare share = interface_.at(o_h);
    const float mirrored = share.mirror_chance();
    const bool passes = choice >= mirrored && mirrored < 1.0f;
    const Vec3 local = passes ? interface_.pass(wo_, h, share) : normalized_or(2.0f * o_h * h - wo_, Vec3::UnitZ());
    const Vec3 wi = frame_.from_local(local);
    if (!mirror_) {
      if ((local.z() < 0.0f) != passes) return {wi, Vec3::Zero(), 0.0f, passes};
      return weighed(local, wi);
    }
    const bool refracted = passes && interface_.is_body();
    const float left = refracted ? coat_.crossed(wi) : coat_.narrow(wi);
    const float certainty = chance * (passes ? 1.0f - mirrored : mirrored);
    const Vec3 weight = (passes ? share.passed : share.mirrored) * (left / certainty);
    return {wi, weight, 0.0f, passes};
  }

  Frame frame_;
  Vec3 wo_;
  bool mirror_;
  bool bounded_ = true;
  Microfacets facets_;
  GrazingLobe grazing_;
  OpaqueBase base_;
  Interface interface_;
  WideGlass wide_;
  Coat coat_;
  // Light that Coat::narrow() removes in excess; it is added back as a wide lobe.
  Vec3 under_coat_ = Vec3::Zero();
  Vec3 under_coat_albedo_ = Vec3::Zero();
  std::array<float, kLobes> chances_{};
};

}  // namespace cyclorama::render
