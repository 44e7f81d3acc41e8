// SPDX-License-Identifier: Apache-2.0
/// Embree 3.13 (Debian 12) and 4.3 (Debian 13): the only place that knows which. All else uses what both share.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace cyclorama {

/// A hint to the traversal: rays of one pixel run alike, rays that surfaces scatter do not.
enum class Coherence { kCoherent, kIncoherent };

/// Rays are traced this many at a time: as wide as the widest vectors. Processors with narrower ones do it in steps.
inline constexpr int kPacketRays = 16;

/// What Embree wants to be told of a query. Cheap to make.
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

  /// Lanes whose `valid` is -1. Afterwards hit.geomID is RTC_INVALID_GEOMETRY_ID, as before, where nothing was hit.
#if RTC_VERSION_MAJOR >= 4
  void nearest(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, rays, &intersect_); }
  /// Afterwards tfar is below zero where anything lies on the ray.
  void any(RTCScene scene, const int* valid, RTCRay16* rays) { rtcOccluded16(valid, scene, rays, &occluded_); }
#else
  void nearest(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, &context_, rays); }
  /// Afterwards tfar is below zero where anything lies on the ray.
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

}  // namespace cyclorama
