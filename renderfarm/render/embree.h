// SPDX-License-Identifier: Apache-2.0
/// Supports Embree 3.13 (Debian 12) and 4.3 (Debian 13). Only this file depends on the version; all other code uses
/// what both share.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace cyclorama::render {

/// Hint for the traversal: camera rays of one pixel are coherent, scattered rays are not.
enum class Coherence { kCoherent, kIncoherent };

/// Rays per packet: the width of the widest vectors. Processors with narrower ones take several steps.
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

  /// Traces the lanes whose `valid` is -1. Where nothing was hit, hit.geomID stays RTC_INVALID_GEOMETRY_ID.
#if RTC_VERSION_MAJOR >= 4
  void nearest(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, rays, &intersect_); }
  /// Sets tfar below zero where anything lies on the ray.
  void any(RTCScene scene, const int* valid, RTCRay16* rays) { rtcOccluded16(valid, scene, rays, &occluded_); }
#else
  void nearest(RTCScene scene, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene, &context_, rays); }
  /// Sets tfar below zero where anything lies on the ray.
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

}  // namespace cyclorama::render
