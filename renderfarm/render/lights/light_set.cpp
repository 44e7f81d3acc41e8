// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_set.h"

#include <bit>
#include <cmath>

#include "renderfarm/render/sampler.h"

namespace cyclorama::render {
namespace {

/// Share of the probability that is divided evenly among the kinds of light that shine. Estimates ignore occlusion, and
/// that of the sun is often a thousand times that of a lamp, even indoors. The even share raises the variance by at
/// most a third where the estimates are right, and bounds it where they are wrong.
constexpr float kEvenShare = 0.25f;

/// Returns one random number for all choices. The float's 24 bits do not suffice for a tree of a million lights, so
/// further bits are hashed from them and from `u`.
Choice choice_of(float choice, const Vec2& u) {
  const std::uint32_t more =
      mix_bits(std::bit_cast<std::uint32_t>(choice) ^
               mix_bits(std::bit_cast<std::uint32_t>(u.x()) ^ mix_bits(std::bit_cast<std::uint32_t>(u.y()))));
  return Choice(std::min(static_cast<double>(choice) + static_cast<double>(more >> 4) * 0x1p-52, 0x1.fffffffffffffp-1));
}

void divide(float probability, LightSample* sample) {
  sample->radiance_over_pdf /= probability;
  sample->pdf *= probability;
}

LightBounds bounds_of(const Lamp& lamp) {
  LightBounds bounds;
  bounds.low = lamp.position.array() - lamp.radius;
  bounds.high = lamp.position.array() + lamp.radius;
  const bool is_spot = lamp.kind == scene::LightKind::kSpot;
  bounds.normals = {lamp.axis, is_spot ? 1.0f : -1.0f};
  bounds.cos_emission = is_spot ? lamp.cos_outer : 0.0f;
  bounds.power = lamp.power;
  bounds.inverse_range = lamp.inverse_range;
  return bounds;
}

LightBounds bounds_of(const FlatLight& light) {
  const Vec3 reach = light.half.x() * light.across.cwiseAbs() + light.half.y() * light.up.cwiseAbs();
  LightBounds bounds;
  bounds.low = light.centre - reach;
  bounds.high = light.centre + reach;
  bounds.normals = {light.normal, 1.0f};
  bounds.cos_emission = 0.0f;
  bounds.power = luminance(light.radiance) * light.area();
  return bounds;
}

}  // namespace

LightSet::LightSet(const std::vector<scene::Light>& lights, const Eigen::Vector3d& origin,
                   const std::vector<Placement>& placements, const scene::Sky& sky,
                   std::shared_ptr<const scene::EnvironmentMap> environment)
    : triangles_(placements), environment_(sky, std::move(environment)) {
  for (const scene::Light& light : lights) {
    if (scene::is_flat(light.kind)) {
      const FlatLight flat = make_flat_light(light, origin);
      if (is_lit(flat)) flats_.push_back(flat);
      continue;
    }
    const Lamp lamp = make_lamp(light, origin);
    if (is_lit(lamp)) (lamp.kind == scene::LightKind::kDirectional ? suns_ : lamps_).push_back(lamp);
  }
  if (size() <= LightList::kMaxListedLights) {
    for (std::size_t i = 0; i < size(); ++i) list_.add(bounds(i));
    return;
  }
  std::vector<LightBounds> all;
  all.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) all.push_back(bounds(i));
  tree_ = LightTree(all);
}

LightBounds LightSet::bounds(std::size_t light) const {
  if (light < lamps_.size()) return bounds_of(lamps_[light]);
  light -= lamps_.size();
  return light < flats_.size() ? bounds_of(flats_[light]) : triangles_.bounds(light - flats_.size());
}

float LightSet::sun_estimate(const Lamp& sun, const Vec3& n) const {
  if (n.isZero(0.0f)) return sun.power;
  return sun.power * std::clamp(sun.sin_disc - n.dot(sun.axis), 0.0f, 1.0f);
}

float LightSet::suns_estimate(const Vec3& n) const {
  float sum = 0.0f;
  for (const Lamp& sun : suns_) sum += sun_estimate(sun, n);
  return sum;
}

LightSet::Shares LightSet::shares(float finite, const Vec3& n) const {
  Shares shares{finite, suns_estimate(n), environment_.estimate(n)};
  const float sum = shares.finite + shares.suns + shares.environment;
  if (!(sum > 0.0f) || !std::isfinite(sum)) return {};
  const int kinds = (shares.finite > 0.0f ? 1 : 0) + (shares.suns > 0.0f ? 1 : 0) + (shares.environment > 0.0f ? 1 : 0);
  for (float* const share : {&shares.finite, &shares.suns, &shares.environment}) {
    if (!(*share > 0.0f)) continue;
    *share = kinds == 1 ? 1.0f : (1.0f - kEvenShare) * (*share / sum) + kEvenShare / static_cast<float>(kinds);
  }
  return shares;
}

bool LightSet::sample(const Vec3& p, const Vec3& n, float choice, const Vec2& u, LightSample* ret_sample) const {
  ret_sample->group = 0;
  Choice selection = choice_of(choice, u);
  LightList::Estimates estimates;
  if (tree_.empty()) list_.estimate(p, n, &estimates);
  const Shares share = shares(tree_.empty() ? estimates.sum : tree_.estimate(p, n), n);
  // The last kind takes the remainder, including rounding errors.
  if (share.finite > 0.0f && selection.takes(static_cast<double>(share.finite))) {
    float probability = 0.0f;
    const int light =
        tree_.empty() ? list_.choose(estimates, selection, &probability) : tree_.choose(p, n, &selection, &probability);
    if (light < 0 || !sample_finite(light, p, u, ret_sample)) return false;
    divide(share.finite * probability, ret_sample);
    return true;
  }
  const float rest = share.suns + share.environment;
  if (!(rest > 0.0f)) return false;
  if (share.suns > 0.0f && selection.takes(static_cast<double>(share.suns / rest))) {
    if (!sample_sun(n, selection, u, ret_sample)) return false;
    divide(share.suns, ret_sample);
    return true;
  }
  if (!(share.environment > 0.0f) || !environment_.sample(n, u, ret_sample)) return false;
  divide(share.environment, ret_sample);
  return true;
}

bool LightSet::sample_finite(LightIndex light, const Vec3& p, const Vec2& u, LightSample* ret_sample) const {
  auto index = static_cast<std::size_t>(light);
  if (index < lamps_.size()) {
    *ret_sample = sample_lamp(lamps_[index], p, u);
    ret_sample->group = lamps_[index].group;
    return true;
  }
  index -= lamps_.size();
  if (index >= flats_.size()) return triangles_.sample(index - flats_.size(), p, u, ret_sample);
  if (!sample_flat(flats_[index], p, u, ret_sample)) return false;
  ret_sample->group = flats_[index].group;
  return true;
}

bool LightSet::sample_sun(const Vec3& n, const Choice& choice, const Vec2& u, LightSample* ret_sample) const {
  const float sum = suns_estimate(n);
  double left = choice.number() * static_cast<double>(sum);
  const Lamp* chosen = nullptr;
  float estimate = 0.0f;
  for (const Lamp& sun : suns_) {
    const float e = sun_estimate(sun, n);
    if (!(e > 0.0f)) continue;
    chosen = &sun;
    estimate = e;
    left -= static_cast<double>(e);
    if (left < 0.0) break;
  }
  if (chosen == nullptr) return false;
  *ret_sample = sample_lamp(*chosen, Vec3::Zero(), u);
  ret_sample->group = chosen->group;
  divide(estimate / sum, ret_sample);
  return true;
}

float LightSet::finite_pdf(LightIndex light, const Vec3& p, const Vec3& direction, float distance) const {
  auto index = static_cast<std::size_t>(light);
  if (index < lamps_.size()) return lamp_pdf(lamps_[index], p);
  index -= lamps_.size();
  return index < flats_.size() ? flat_pdf(flats_[index], p, direction, distance)
                               : triangles_.pdf(index - flats_.size(), p, direction, distance);
}

float LightSet::pdf(const Vec3& p, const Vec3& n, LightIndex light, const Vec3& direction, float distance) const {
  if (light < 0) return 0.0f;
  const float aimed = finite_pdf(light, p, direction, distance);
  if (!(aimed > 0.0f)) return 0.0f;
  float all = 0.0f;
  float chosen = 0.0f;
  if (tree_.empty()) {
    LightList::Estimates estimates;
    list_.estimate(p, n, &estimates);
    all = estimates.sum;
    chosen = all > 0.0f ? estimates.each[static_cast<std::size_t>(light)] / all : 0.0f;
  } else {
    all = tree_.estimate(p, n);
    chosen = tree_.probability(p, n, light);
  }
  return aimed * chosen * shares(all, n).finite;
}

float LightSet::environment_pdf(const Vec3& p, const Vec3& n, const Vec3& direction) const {
  if (!environment_.shines()) return 0.0f;
  float finite = 0.0f;
  if (tree_.empty()) {
    LightList::Estimates estimates;
    list_.estimate(p, n, &estimates);
    finite = estimates.sum;
  } else {
    finite = tree_.estimate(p, n);
  }
  return environment_.pdf(n, direction) * shares(finite, n).environment;
}

LightIndex LightSet::of_triangle(unsigned placement, unsigned primitive) const {
  const int triangle = triangles_.find(placement, primitive);
  return triangle < 0 ? kNoLight : static_cast<LightIndex>(lamps_.size() + flats_.size()) + triangle;
}

Vec3 LightSet::radiance(LightIndex light, const Vec3& p, const Vec3& direction) const {
  auto index = static_cast<std::size_t>(light);
  if (light < 0) return Vec3::Zero();
  if (index < lamps_.size()) return lamp_radiance(lamps_[index], p);
  index -= lamps_.size();
  if (index >= flats_.size() || !(flats_[index].normal.dot(direction) < 0.0f)) return Vec3::Zero();
  return flats_[index].radiance;
}

std::size_t LightSet::group_of(LightIndex light) const {
  auto index = static_cast<std::size_t>(light);
  if (light < 0) return 0;
  if (index < lamps_.size()) return lamps_[index].group;
  index -= lamps_.size();
  return index < flats_.size() ? flats_[index].group : 0;
}

std::size_t LightSet::bytes() const {
  return lamps_.capacity() * sizeof(Lamp) + flats_.capacity() * sizeof(FlatLight) + triangles_.bytes() + tree_.bytes();
}

}  // namespace cyclorama::render
