// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/walkable/ray_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "renderfarm/render/embree.h"

namespace cyclorama::walkable {
namespace {

static_assert(RayProbe::kBatch == render::kPacketRays);

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

bool is_solid(const scene::Model& model, const scene::Mesh& mesh) {
  return model.materials[static_cast<std::size_t>(mesh.material)].alpha_mode != scene::AlphaMode::kBlend &&
         !mesh.triangles.empty();
}

bool is_placeable(const Eigen::Affine3f& T) {
  return T.matrix().allFinite() && std::isnormal(T.linear().determinant()) &&
         std::isfinite(1.0f / T.linear().determinant());
}

}  // namespace

struct RayProbe::Embree {
  Device device;
  std::vector<EmbreeScene> meshes;  ///< Null for meshes that are not solid or not placed.
  EmbreeScene top;
  Eigen::Vector3d origin;

  [[nodiscard]] Status check() const {
    const RTCError code = rtcGetDeviceError(device.get());
    if (code == RTC_ERROR_NONE) return Done{};
    return Error(ErrorCode::kSystem,
                 fmt::format("Embree gave up on the scene (code {}); {}", static_cast<int>(code),
                             code == RTC_ERROR_OUT_OF_MEMORY ? "it needs more memory" : "report this"));
  }
  [[nodiscard]] EmbreeScene mesh_scene(const scene::Mesh& mesh) const {
    EmbreeScene scene(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    // Vertices are copied with padding, because Embree reads them 16 bytes at a time, which would exceed an array
    // without padding.
    auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    if (vertices != nullptr) std::copy_n(mesh.positions.front().data(), 3 * mesh.positions.size(), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               3 * sizeof(std::uint32_t), mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.get());
    return scene;
  }
  void place(const EmbreeScene& mesh, const Eigen::Affine3f& T) const {
    RTCGeometry instance = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh.get());
    rtcSetGeometryTimeStepCount(instance, 1);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, T.matrix().data());
    rtcCommitGeometry(instance);
    rtcAttachGeometry(top.get(), instance);
    rtcReleaseGeometry(instance);
  }
};

RayProbe::RayProbe(std::unique_ptr<Embree> embree) : embree_(std::move(embree)) {}
RayProbe::RayProbe(RayProbe&&) noexcept = default;
RayProbe& RayProbe::operator=(RayProbe&&) noexcept = default;
RayProbe::~RayProbe() = default;

Result<RayProbe> RayProbe::build(const scene::Scene& scene, const Eigen::Vector3d& near) {
  auto embree = std::make_unique<Embree>();
  embree->device.reset(rtcNewDevice(""));
  embree->origin = near;
  TRY(embree->check());
  embree->top.reset(rtcNewScene(embree->device.get()));
  rtcSetSceneFlags(embree->top.get(), RTC_SCENE_FLAG_ROBUST);
  embree->meshes.resize(scene.model.meshes.size());
  for (const scene::Instance& instance : scene.model.instances) {
    const auto index = static_cast<std::size_t>(instance.mesh);
    const scene::Mesh& mesh = scene.model.meshes[index];
    const Eigen::Affine3d T_near_mesh =
        Eigen::Translation3d(-near) * instance.T_model_mesh * Eigen::Translation3d(mesh.origin);
    const Eigen::Affine3f T(T_near_mesh.matrix().cast<float>());
    if (!is_solid(scene.model, mesh) || !is_placeable(T)) continue;
    if (embree->meshes[index] == nullptr) embree->meshes[index] = embree->mesh_scene(mesh);
    embree->place(embree->meshes[index], T);
  }
  rtcCommitScene(embree->top.get());
  TRY(embree->check());
  return RayProbe(std::move(embree));
}

std::vector<double> RayProbe::heights(const std::vector<Eigen::Vector2d>& places, double top, double bottom) const {
  CHECK(places.size() <= kBatch);
  alignas(64) RTCRayHit16 rays{};
  alignas(64) std::array<int, kBatch> valid{};
  const Eigen::Vector3d& origin = embree_->origin;
  for (std::size_t i = 0; i < places.size(); ++i) {
    valid[i] = -1;
    rays.ray.org_x[i] = static_cast<float>(places[i].x() - origin.x());
    rays.ray.org_y[i] = static_cast<float>(top - origin.y());
    rays.ray.org_z[i] = static_cast<float>(places[i].y() - origin.z());
    rays.ray.dir_y[i] = -1.0f;
    rays.ray.tfar[i] = static_cast<float>(top - bottom);
    rays.ray.mask[i] = ~0u;
    rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  render::Query query(render::Coherence::kCoherent);
  query.nearest(embree_->top.get(), valid.data(), &rays);
  std::vector<double> heights(places.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID) heights[i] = top - static_cast<double>(rays.ray.tfar[i]);
  }
  return heights;
}

bool RayProbe::is_clear_around(const Eigen::Vector3d& from, double length) const {
  alignas(64) RTCRay16 rays{};
  alignas(64) std::array<int, kBatch> valid{};
  const Eigen::Vector3f start = (from - embree_->origin).cast<float>();
  for (std::size_t i = 0; i < kBatch; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kBatch;
    valid[i] = -1;
    rays.org_x[i] = start.x();
    rays.org_y[i] = start.y();
    rays.org_z[i] = start.z();
    rays.dir_x[i] = static_cast<float>(std::cos(angle));
    rays.dir_z[i] = static_cast<float>(std::sin(angle));
    rays.tfar[i] = static_cast<float>(length);
    rays.mask[i] = ~0u;
  }
  render::Query query(render::Coherence::kIncoherent);
  query.any(embree_->top.get(), valid.data(), &rays);
  return std::all_of(std::begin(rays.tfar), std::end(rays.tfar), [](float end) { return end >= 0.0f; });
}

std::optional<double> RayProbe::distance(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                                         double length) const {
  alignas(64) RTCRayHit16 rays{};
  alignas(64) std::array<int, kBatch> valid{};
  const Eigen::Vector3f start = (from - embree_->origin).cast<float>();
  const Eigen::Vector3f along = direction.normalized().cast<float>();
  valid[0] = -1;
  rays.ray.org_x[0] = start.x();
  rays.ray.org_y[0] = start.y();
  rays.ray.org_z[0] = start.z();
  rays.ray.dir_x[0] = along.x();
  rays.ray.dir_y[0] = along.y();
  rays.ray.dir_z[0] = along.z();
  rays.ray.tfar[0] = static_cast<float>(length);
  rays.ray.mask[0] = ~0u;
  rays.hit.geomID[0] = RTC_INVALID_GEOMETRY_ID;
  render::Query query(render::Coherence::kIncoherent);
  query.nearest(embree_->top.get(), valid.data(), &rays);
  if (rays.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return static_cast<double>(rays.ray.tfar[0]);
}

}  // namespace cyclorama::walkable
