// SPDX-License-Identifier: Apache-2.0
/// Supports Embree 3.13 (Debian 12) and 4.3 (Debian 13). Only this file depends on the version; all other code uses
/// only what both versions share.
#pragma once

#include <Eigen/Core>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace cyclorama::render {

/// Hint for the traversal: camera rays of one pixel are coherent, scattered rays are not.
enum class Coherence { kCoherent, kIncoherent };

/// Rays per packet: the number of lanes of the widest vector registers. Processors with narrower registers take several
/// steps.
inline constexpr int kPacketRays = 16;

/// Embree's query arguments. Cheap to construct.
class Query {
 public:
  explicit Query(Coherence coherence) {
    const bool coherent = coherence == Coherence::kCoherent;
#if RTC_VERSION_MAJOR >= 4
    rtcInitIntersectArguments(&intersect_);
    rtcInitOccludedArguments(&occluded_);
    intersect_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    occluded_.flags = intersect_.flags;
#else
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
  }

  /// Finds the nearest hits of the lanes whose `valid` is -1. If a ray hits nothing, its hit.geomID stays
  /// RTC_INVALID_GEOMETRY_ID.
#if RTC_VERSION_MAJOR >= 4
  void nearest(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, rays, &intersect_); }
  /// Sets tfar below zero for each ray that hits anything.
  void any(RTCScene scene, const int* valid, RTCRay16* rays) { rtcOccluded16(valid, scene, rays, &occluded_); }
#else
  void nearest(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, &context_, rays); }
  /// Sets tfar below zero for each ray that hits anything.
  void any(RTCScene scene, const int* valid, RTCRay16* rays) { rtcOccluded16(valid, scene, &context_, rays); }
#endif

 private:
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments intersect_;
  RTCOccludedArguments occluded_;
#else
  RTCIntersectContext context_;
#endif
};

/// A query of one ray that carries data for the callbacks of user geometries. Thread-bound.
template <typename Payload>
struct RayContext {
#if RTC_VERSION_MAJOR >= 4
  RTCRayQueryContext base;
#else
  RTCIntersectContext base;
#endif
  Payload payload;

  RayContext() {
#if RTC_VERSION_MAJOR >= 4
    rtcInitRayQueryContext(&base);
#else
    rtcInitIntersectContext(&base);
#endif
  }
  /// Returns the payload of the query to which `context` belongs. Precondition: nearest() of a RayContext with this
  /// type of payload started the query.
  template <typename Base>
  static Payload* of(Base* context) {
    return &reinterpret_cast<RayContext*>(context)->payload;
  }
  /// Calls the callbacks of the user geometries that the ray meets between `near_m` and `far_m`.
  void nearest(RTCScene scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_m,
               float far_m) {
    RTCRayHit ray{};
    ray.ray.org_x = origin.x();
    ray.ray.org_y = origin.y();
    ray.ray.org_z = origin.z();
    ray.ray.tnear = near_m;
    ray.ray.dir_x = direction.x();
    ray.ray.dir_y = direction.y();
    ray.ray.dir_z = direction.z();
    ray.ray.tfar = far_m;
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &base;
    rtcIntersect1(scene, &ray, &arguments);
#else
    rtcIntersect1(scene, &base, &ray);
#endif
  }
};

}  // namespace cyclorama::render
