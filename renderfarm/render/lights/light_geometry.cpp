// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/light_geometry.h"

namespace cyclorama::render {
namespace {

enum Shape : unsigned { kQuads, kDiscs, kSpheres };

using Vector = std::array<float, 3>;
using Ball = std::array<float, 4>;  ///< Centre and radius.

Vector to_array(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Fills a new buffer owned by Embree with `values`; does nothing if it could not be allocated.
template <typename T>
void fill(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const std::vector<T>& values) {
  void* const memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), values.size());
  if (memory != nullptr) std::copy(values.begin(), values.end(), static_cast<T*>(memory));
}

void attach(RTCGeometry geometry, unsigned id, RTCScene top) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(top, geometry, id);
  rtcReleaseGeometry(geometry);
}

}  // namespace

LampGeometries attach_lamps(const LightSet& lights, unsigned first, RTCDevice device, RTCScene top) {
  LampGeometries made;
  made.first_ = first;
  std::vector<Vector> corners;
  std::vector<std::array<unsigned, 4>> quads;
  std::vector<Ball> discs;
  std::vector<Vector> normals;
  std::vector<Ball> spheres;
  for (std::size_t i = 0; i < lights.flats().size(); ++i) {
    const FlatLight& light = lights.flats()[i];
    if (!light.visible) continue;
    made.lights_[light.is_disk ? kDiscs : kQuads].push_back(lights.index_of_flat(i));
    if (light.is_disk) {
      discs.push_back({light.centre.x(), light.centre.y(), light.centre.z(), light.half.x()});
      normals.push_back(to_array(light.normal));
      continue;
    }
    const auto corner = static_cast<unsigned>(corners.size());
    const Vec3 x = light.half.x() * light.across;
    const Vec3 y = light.half.y() * light.up;
    for (const Vec3& at : {Vec3(light.centre - x - y), Vec3(light.centre + x - y), Vec3(light.centre + x + y),
                           Vec3(light.centre - x + y)}) {
      corners.push_back(to_array(at));
    }
    quads.push_back({corner, corner + 1, corner + 2, corner + 3});
  }
  for (std::size_t i = 0; i < lights.lamps().size(); ++i) {
    const Lamp& lamp = lights.lamps()[i];
    if (!lamp.visible) continue;
    made.lights_[kSpheres].push_back(lights.index_of_lamp(i));
    spheres.push_back({lamp.position.x(), lamp.position.y(), lamp.position.z(), lamp.radius});
  }
  if (!quads.empty()) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    fill(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, corners);
    fill(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, quads);
    attach(geometry, first + kQuads, top);
  }
  if (!discs.empty()) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    fill(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, discs);
    fill(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, normals);
    attach(geometry, first + kDiscs, top);
  }
  if (!spheres.empty()) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    fill(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, spheres);
    attach(geometry, first + kSpheres, top);
  }
  return made;
}

}  // namespace cyclorama::render
