// SPDX-License-Identifier: Apache-2.0
/// Rays in packets, the form in which Embree takes them.
#pragma once

#include <array>
#include <cstdint>

#include "renderfarm/render/embree.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Upper bound of the rays of one batch.
inline constexpr int kMaxRays = 1024;
static_assert(kMaxRays % kPacketRays == 0);

/// Up to kMaxRays rays, numbered in the order in which they were added. `Packet` is RTCRay16 or RTCRayHit16.
/// Thread-bound.
template <typename Packet>
class RayQueue {
 public:
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool full() const { return count_ == kMaxRays; }
  void clear() { count_ = 0; }

  /// Adds a ray. `random_number` seeds the decisions at half-transparent surfaces on its way. Precondition: not full.
  void add(const Vec3& origin, const Vec3& direction, float far, std::uint32_t random_number) {
    RTCRay16& ray = rays_of(packet(count_));
    const int lane = lane_of(count_++);
    ray.org_x[lane] = origin.x();
    ray.org_y[lane] = origin.y();
    ray.org_z[lane] = origin.z();
    ray.tnear[lane] = 0.0f;  // Origins are already off the surface, so no distance needs to be skipped.
    ray.dir_x[lane] = direction.x();
    ray.dir_y[lane] = direction.y();
    ray.dir_z[lane] = direction.z();
    ray.time[lane] = 0.0f;
    ray.tfar[lane] = far;
    ray.mask[lane] = ~0u;
    ray.id[lane] = random_number;
    ray.flags[lane] = 0;
    if constexpr (kFindsHits) {
      packet(count_ - 1).hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet(count_ - 1).hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
  }

  [[nodiscard]] Vec3 origin(int i) const {
    const RTCRay16& ray = rays_of(packet(i));
    const int lane = lane_of(i);
    return {ray.org_x[lane], ray.org_y[lane], ray.org_z[lane]};
  }
  [[nodiscard]] Vec3 direction(int i) const {
    const RTCRay16& ray = rays_of(packet(i));
    const int lane = lane_of(i);
    return {ray.dir_x[lane], ray.dir_y[lane], ray.dir_z[lane]};
  }
  [[nodiscard]] std::uint32_t random_number(int i) const { return rays_of(packet(i)).id[lane_of(i)]; }
  /// Returns the distance of the hit; below zero if trace_any() found an occluder.
  [[nodiscard]] float distance(int i) const { return rays_of(packet(i)).tfar[lane_of(i)]; }
  /// Precondition of has_hit() and hit(): `Packet` is RTCRayHit16, and the rays have been traced.
  [[nodiscard]] bool has_hit(int i) const { return packet(i).hit.geomID[lane_of(i)] != RTC_INVALID_GEOMETRY_ID; }
  [[nodiscard]] RTCHit hit(int i) const {
    const RTCHit16& hits = packet(i).hit;
    const int lane = lane_of(i);
    RTCHit hit;
    hit.u = hits.u[lane];
    hit.v = hits.v[lane];
    hit.primID = hits.primID[lane];
    hit.geomID = hits.geomID[lane];
    hit.instID[0] = hits.instID[0][lane];
    return hit;
  }

  /// Copies ray `from`, with its hit, to number `to`.
  void move(int from, int to) {
    const Packet& source = packet(from);
    Packet& target = packet(to);
    copy_ray(rays_of(source), lane_of(from), rays_of(target), lane_of(to));
    if constexpr (kFindsHits) copy_hit(source.hit, lane_of(from), target.hit, lane_of(to));
  }
  /// Keeps the first `count` rays. Precondition: `count` is at most count().
  void shorten(int count) { count_ = count; }

  /// Returns packet number i / kPacketRays, which holds ray `i`.
  [[nodiscard]] Packet& packet(int i) { return packets_[static_cast<std::size_t>(i / kPacketRays)]; }

 private:
  static constexpr bool kFindsHits = std::is_same_v<Packet, RTCRayHit16>;
  static int lane_of(int i) { return i % kPacketRays; }
  const Packet& packet(int i) const { return packets_[static_cast<std::size_t>(i / kPacketRays)]; }
  static RTCRay16& rays_of(RTCRay16& packet) { return packet; }
  static const RTCRay16& rays_of(const RTCRay16& packet) { return packet; }
  static RTCRay16& rays_of(RTCRayHit16& packet) { return packet.ray; }
  static const RTCRay16& rays_of(const RTCRayHit16& packet) { return packet.ray; }

  static void copy_ray(const RTCRay16& from, int lane, RTCRay16& to, int to_lane) {
    to.org_x[to_lane] = from.org_x[lane];
    to.org_y[to_lane] = from.org_y[lane];
    to.org_z[to_lane] = from.org_z[lane];
    to.tnear[to_lane] = from.tnear[lane];
    to.dir_x[to_lane] = from.dir_x[lane];
    to.dir_y[to_lane] = from.dir_y[lane];
    to.dir_z[to_lane] = from.dir_z[lane];
    to.time[to_lane] = from.time[lane];
    to.tfar[to_lane] = from.tfar[lane];
    to.mask[to_lane] = from.mask[lane];
    to.id[to_lane] = from.id[lane];
    to.flags[to_lane] = from.flags[lane];
  }
  static void copy_hit(const RTCHit16& from, int lane, RTCHit16& to, int to_lane) {
    to.u[to_lane] = from.u[lane];
    to.v[to_lane] = from.v[lane];
    to.primID[to_lane] = from.primID[lane];
    to.geomID[to_lane] = from.geomID[lane];
    to.instID[0][to_lane] = from.instID[0][lane];
  }

  int count_ = 0;
  std::array<Packet, kMaxRays / kPacketRays> packets_;
};

/// Finds the nearest hit of each ray. Reentrant.
void trace_nearest(RTCScene scene, Coherence coherence, RayQueue<RTCRayHit16>& rays);
/// Tests each ray for occlusion; the distance() of an occluded ray is below zero. Reentrant.
void trace_any(RTCScene scene, RayQueue<RTCRay16>& rays);

}  // namespace cyclorama::render
