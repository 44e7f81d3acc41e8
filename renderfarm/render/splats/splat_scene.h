// SPDX-License-Identifier: Apache-2.0
/// Gaussian splats for ray tracing. They are in a separate Embree scene, so that scenes without splats have no extra
/// cost.
///
/// A splat attenuates a ray once, at the point of the ray where its Gaussian is highest: by its opacity times the value
/// of the Gaussian there divided by the value at its centre. These points determine the order of the splats, so
/// pictures are exact in every projection, whereas the original program approximates projections. All other rules are
/// those of the original program: opacities are at most 0.99, splats that contribute less than 1/255 are left out, and
/// a ray ends where less than 1/10,000 of it would remain.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/embree.h"
#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/splat_cloud.h"

namespace cyclorama::render {

inline constexpr float kMaxSplatAlpha = 0.99f;
inline constexpr float kMinSplatAlpha = 1.0f / 255.0f;
inline constexpr float kMinSplatTransmittance = 1e-4f;

/// Light and attenuation that a ray gathers from splats.
struct SplatLight {
  Vec3 colour = Vec3::Zero();  ///< Weighted by opacity; in code values unless SplatScene::is_linear().
  float transmittance = 1.0f;  ///< Fraction of the light from behind that passes through.
  float depth_m = std::numeric_limits<float>::infinity();  ///< Distance at which half of the ray's light is blocked.
};

/// The splats of a scene. Thread-safe once built.
class SplatScene {
 public:
  /// Borrows the clouds, which must outlive it and not change. `origin` is the origin of the render frame, in the
  /// model's frame. Errors: kSystem if Embree fails or memory runs out.
  static Result<std::unique_ptr<SplatScene>> build(std::span<const scene::SplatCloud> clouds,
                                                   const Eigen::Vector3d& origin, RTCDevice device);
  ~SplatScene();
  SplatScene(const SplatScene&) = delete;
  SplatScene& operator=(const SplatScene&) = delete;

  /// Gathers the light of the splats on a ray before `far_m`. `direction` has unit length. Render frame.
  [[nodiscard]] SplatLight trace(const Vec3& origin, const Vec3& direction, float far_m) const;
  /// Returns true if all colours are blended as linear light.
  [[nodiscard]] bool is_linear() const { return is_linear_; }
  [[nodiscard]] std::size_t bytes() const { return records_.size() * sizeof(Record); }

 private:
  /// Data of one splat, in one cache line.
  struct alignas(64) Record {
    Vec3 centre;
    Eigen::Matrix3f T_unit_render;  ///< Transforms the splat to the unit Gaussian.
    float opacity;
    std::uint32_t cloud;
    std::uint32_t splat;
  };
  static_assert(sizeof(Record) == 64);
  struct Cloud {
    const scene::SplatCloud* source;
    Eigen::Matrix3f T_cloud_render;  ///< Used only for directions.
  };
  struct Ray;

  SplatScene() = default;
  void add_records(const scene::SplatCloud& cloud, const Eigen::Vector3d& origin);
  [[nodiscard]] Vec3 colour_of(const Record& record, const Vec3& eye) const;
  static void bounds_of(const RTCBoundsFunctionArguments* request);
  static void meet(const RTCIntersectFunctionNArguments* request);

  RTCScene scene_ = nullptr;
  std::vector<Record> records_;
  std::vector<Cloud> clouds_;
  bool is_linear_ = true;
};

}  // namespace cyclorama::render
