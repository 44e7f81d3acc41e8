// SPDX-License-Identifier: Apache-2.0
/// Embree 3.13 (Debian 12) and 4.3 (Debian 13): the only place that knows which. All else uses what both share.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace cyclorama {

/// A hint to the traversal: rays of neighbouring pixels run alike, shadow and sky rays do not.
enum class Coherence { kCoherent, kIncoherent };

inline RTCRay make_ray(const float* origin, const float* direction, float far, unsigned id) {
  RTCRay ray{};
  ray.org_x = origin[0];
  ray.org_y = origin[1];
  ray.org_z = origin[2];
  ray.tnear = 0.0f;  // Origins are already off the surface, so no distance is cut away in front of them.
  ray.dir_x = direction[0];
  ray.dir_y = direction[1];
  ray.dir_z = direction[2];
  ray.tfar = far;
  ray.mask = ~0u;
  ray.id = id;
  return ray;
}

/// Afterwards hit.geomID is RTC_INVALID_GEOMETRY_ID if nothing was hit.
inline void trace_nearest(RTCScene scene, RTCRayHit* ray, Coherence coherence) {
  ray->hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = coherence == Coherence::kCoherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcIntersect1(scene, ray, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherence == Coherence::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect1(scene, &context, ray);
#endif
}

/// Whether anything lies on the ray.
[[nodiscard]] inline bool trace_any(RTCScene scene, RTCRay* ray) {
#if RTC_VERSION_MAJOR >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  rtcOccluded1(scene, ray, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
#endif
  return ray->tfar < 0.0f;
}

}  // namespace cyclorama
