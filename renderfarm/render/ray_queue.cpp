// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/ray_queue.h"

#include <algorithm>

namespace cyclorama::render {
namespace {

using Lanes = std::array<int, kPacketRays>;

/// Calls `trace` with each packet and its valid lanes.
template <typename Packet, typename Trace>
void for_packets(RayQueue<Packet>& rays, const Trace& trace) {
  alignas(64) Lanes valid;
  for (int first = 0; first < rays.count(); first += kPacketRays) {
    const int lanes = std::min(kPacketRays, rays.count() - first);
    for (int lane = 0; lane < kPacketRays; ++lane) valid[static_cast<std::size_t>(lane)] = lane < lanes ? -1 : 0;
    trace(valid.data(), rays.packet(first));
  }
}

}  // namespace

void trace_nearest(RTCScene scene, Coherence coherence, RayQueue<RTCRayHit16>& rays) {
  Query query(coherence);
  for_packets(rays, [&](const int* valid, RTCRayHit16& packet) { query.nearest(scene, valid, &packet); });
}

void trace_any(RTCScene scene, RayQueue<RTCRay16>& rays) {
  // Measured: coherent traversal is slower for shadow rays, even for those from one pixel to one light.
  Query query(Coherence::kIncoherent);
  for_packets(rays, [&](const int* valid, RTCRay16& packet) { query.any(scene, valid, &packet); });
}

}  // namespace cyclorama::render
