// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/accelerator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>

#include "renderfarm/render/bake.h"
#include "renderfarm/render/memory.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/surface.h"

namespace cyclorama {
namespace {

/// While it is built and afterwards, Embree 3.13 and 4.3; measured on meshes of 0.1 to 10 million triangles.
constexpr std::size_t kPeakBytesPerTriangle = 160;
constexpr std::size_t kBytesPerInstance = 1024;
/// Left for the rest of the machine.
constexpr std::size_t kReserveBytes = std::size_t{64} << 20;

/// Whether the ray goes through at this hit. `seed` decides half-transparent surfaces: each by itself, and alike for
/// every order in which the traversal meets them.
bool lets_through(const SurfaceMesh& mesh, const RTCFilterFunctionNArguments& arguments) {
  TriangleHit hit;
  hit.mesh = &mesh;
  const unsigned triangle = RTCHitN_primID(arguments.hit, arguments.N, 0);
  const float u = RTCHitN_u(arguments.hit, arguments.N, 0);
  const float v = RTCHitN_v(arguments.hit, arguments.N, 0);
  hit.corners = mesh.triangles[triangle];
  hit.weights = Vec3(std::max(0.0f, 1.0f - u - v), u, v);
  const float alpha = alpha_at(hit);
  if (mesh.material->cut_out) return alpha < mesh.material->source->alpha_cutoff;
  const std::uint32_t seed = RTCRayN_id(arguments.ray, arguments.N, 0);
  const std::uint32_t instance = RTCHitN_instID(arguments.hit, arguments.N, 0, 0);
  const std::uint32_t geometry = RTCHitN_geomID(arguments.hit, arguments.N, 0);
  return alpha <= to_unit_float(mix_bits(seed ^ mix_bits(triangle ^ mix_bits(geometry ^ mix_bits(instance)))));
}

void filter(const RTCFilterFunctionNArguments* arguments) {
  if (arguments->valid[0] != -1) return;
  const auto& mesh = *static_cast<const SurfaceMesh*>(arguments->geometryUserPtr);
  if (lets_through(mesh, *arguments)) arguments->valid[0] = 0;
}

const Texture* texture_of(const Model& model, const TextureUse& use) {
  return use.texture >= 0 ? &model.textures[static_cast<std::size_t>(use.texture)] : nullptr;
}

SurfaceMaterial trace_material(const Model& model, const Material& source) {
  SurfaceMaterial material;
  material.source = &source;
  material.base_colour = texture_of(model, source.base_colour_texture);
  material.metallic_roughness = texture_of(model, source.metallic_roughness_texture);
  material.normal = texture_of(model, source.normal_texture);
  material.emissive = texture_of(model, source.emissive_texture);
  material.glossy = is_glossy(source);
  material.cut_out = source.alpha_mode == AlphaMode::kMask;
  return material;
}

template <typename T>
const T* data_or_null(const std::vector<T>& values) {
  return values.empty() ? nullptr : values.data();
}

SurfaceMesh trace_mesh(const Mesh& mesh) {
  SurfaceMesh traced;
  traced.positions = mesh.positions.data();
  traced.triangles = mesh.triangles.data();
  traced.normals = data_or_null(mesh.normals);
  traced.texcoords = {data_or_null(mesh.texcoords[0]), data_or_null(mesh.texcoords[1])};
  traced.tangents = data_or_null(mesh.tangents);
  traced.colours = data_or_null(mesh.colours);
  return traced;
}

Placement place(const SurfaceMesh& mesh, const Eigen::Affine3d& T_render_mesh) {
  Placement placement;
  placement.mesh = &mesh;
  placement.baked = false;
  placement.linear = T_render_mesh.linear().cast<float>();
  placement.translation = T_render_mesh.translation().cast<float>();
  placement.normal_matrix = normal_matrix_of(T_render_mesh.linear());
  return placement;
}

/// What is flattened has no inside for a ray to reach, and Embree cannot invert it.
bool is_placeable(const Placement& placement) {
  const float volume = placement.linear.determinant();
  return std::isnormal(volume) && std::isfinite(1.0f / volume) && is_finite(placement.translation);
}

Status check_memory(std::size_t triangles, std::size_t instances, std::int64_t* ret_limit) {
  const std::optional<std::size_t> available = available_memory();
  *ret_limit = std::numeric_limits<std::int64_t>::max();
  if (!available) return Done{};
  const std::size_t free = *available > kReserveBytes ? *available - kReserveBytes : 0;
  *ret_limit = static_cast<std::int64_t>(free);
  const std::size_t need = triangles * kPeakBytesPerTriangle + instances * kBytesPerInstance;
  if (need <= free) return Done{};
  return Error(
      ErrorCode::kSystem,
      fmt::format("the BVH of {:.1f} million triangles needs about {} and {} are free; take a coarser scene or "
                  "a machine with more memory",
                  static_cast<double>(triangles) / 1e6, describe_bytes(need), describe_bytes(free)));
}

}  // namespace

Result<std::unique_ptr<Accelerator>> Accelerator::build(Scene& scene, int threads,
                                                        const std::function<void(double)>& progress,
                                                        TraceScene* ret_traced) {
  std::unique_ptr<Accelerator> accelerator(new Accelerator());
  std::size_t triangles = 0;
  const std::vector<int> uses = uses_of_meshes(scene.model);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i] > 0) triangles += scene.model.meshes[i].triangles.size();
  }
  if (triangles == 0) {
    return Error(ErrorCode::kInvalidArgument, "the scene has no triangles, so there is nothing to render");
  }
  TRY(check_memory(triangles, scene.model.instances.size(), &accelerator->limit_bytes_));
  TRY(accelerator->open_device(threads));
  TRY(accelerator->add_meshes(scene, ret_traced));
  TRY(accelerator->commit(progress));
  return accelerator;
}

Accelerator::~Accelerator() {
  if (top_ != nullptr) rtcReleaseScene(top_);
  for (const Part& part : parts_) rtcReleaseScene(part.scene);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

Status Accelerator::open_device(int threads) {
  device_ = rtcNewDevice(threads > 0 ? fmt::format("threads={}", threads).c_str() : "");
  TRY(check("opening Embree"));
  if (rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED) == 0) {
    return Error(ErrorCode::kSystem, "this Embree is built without filter functions, which cut-out materials need");
  }
  rtcSetDeviceMemoryMonitorFunction(device_, &count_memory, this);
  top_ = rtcNewScene(device_);
  rtcSetSceneFlags(top_, RTC_SCENE_FLAG_ROBUST);
  return check("making a scene");
}

bool Accelerator::count_memory(void* self, ssize_t bytes, bool post) {
  auto& accelerator = *static_cast<Accelerator*>(self);
  const std::int64_t before = accelerator.bytes_.fetch_add(bytes);
  if (post || bytes <= 0 || before + bytes <= accelerator.limit_bytes_) return true;
  accelerator.bytes_.fetch_sub(bytes);
  return false;
}

Status Accelerator::check(const char* doing) const {
  const RTCError code = rtcGetDeviceError(device_);
  switch (code) {
    case RTC_ERROR_NONE:
      return Done{};
    case RTC_ERROR_OUT_OF_MEMORY:
      return Error(ErrorCode::kSystem,
                   fmt::format("{}: out of memory: {} are taken and {} were free; take a coarser "
                               "scene or a machine with more memory",
                               doing, describe_bytes(bytes()), describe_bytes(static_cast<std::size_t>(limit_bytes_))));
    case RTC_ERROR_UNSUPPORTED_CPU:
      return Error(ErrorCode::kSystem,
                   fmt::format("{}: Embree does not support this processor (SSE2 is needed)", doing));
    default:
      return Error(ErrorCode::kSystem, fmt::format("{}: Embree reports error {}", doing, static_cast<int>(code)));
  }
}

RTCGeometry Accelerator::make_triangles(const Mesh& mesh, SurfaceMesh* traced) {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                             sizeof(mesh.positions[0]), mesh.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(mesh.triangles[0]), mesh.triangles.size());
  rtcSetGeometryUserData(geometry, traced);
  // Eye rays go through half-transparent surfaces in order and see each of them; other rays by lot.
  if (traced->material->cut_out) rtcSetGeometryIntersectFilterFunction(geometry, &filter);
  if (traced->material->cut_out || traced->material->blends) rtcSetGeometryOccludedFilterFunction(geometry, &filter);
  rtcCommitGeometry(geometry);
  return geometry;
}

Status Accelerator::add_meshes(Scene& scene, TraceScene* ret_traced) {
  Model& model = scene.model;
  const Eigen::Vector3d origin = render_origin(scene);
  const std::vector<int> uses = uses_of_meshes(model);
  for (const Material& material : model.materials) ret_traced->materials.push_back(trace_material(model, material));
  // One mesh's alpha may differ from another's of the same material, so each mesh may need its own.
  ret_traced->materials.reserve(model.materials.size() + model.meshes.size());
  ret_traced->meshes.reserve(model.meshes.size());

  std::vector<RTCScene> scene_of_mesh(model.meshes.size(), nullptr);
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    Mesh& mesh = model.meshes[i];
    // Embree reads the last vertex with a 16-byte load: four bytes beyond it must be there to read.
    mesh.positions.reserve(mesh.positions.size() + 1);
    ret_traced->meshes.push_back(trace_mesh(mesh));
    SurfaceMesh& traced = ret_traced->meshes.back();
    const auto material = static_cast<std::size_t>(mesh.material);
    traced.material = &ret_traced->materials[material];
    if (blends(model, model.materials[material], mesh)) {
      ret_traced->materials.push_back(*traced.material);
      ret_traced->materials.back().blends = true;
      traced.material = &ret_traced->materials.back();
    }
    if (uses[i] < 2 || mesh.triangles.empty()) continue;
    const RTCScene part = rtcNewScene(device_);
    rtcSetSceneFlags(part, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = make_triangles(mesh, &traced);
    rtcAttachGeometry(part, geometry);
    rtcReleaseGeometry(geometry);
    scene_of_mesh[i] = part;
    parts_.push_back({part, mesh.triangles.size()});
  }

  for (Instance& instance : model.instances) {
    const auto index = static_cast<std::size_t>(instance.mesh);
    Mesh& mesh = model.meshes[index];
    if (mesh.triangles.empty()) continue;
    Placement placement;
    RTCGeometry geometry = nullptr;
    if (uses[index] == 1) {
      bake(mesh, instance.T_model_mesh, origin);
      instance.T_model_mesh = Eigen::Affine3d::Identity();
      placement.mesh = &ret_traced->meshes[index];
      geometry = make_triangles(mesh, &ret_traced->meshes[index]);
      top_triangles_ += mesh.triangles.size();
    } else {
      const Eigen::Affine3d T_render_mesh =
          Eigen::Translation3d(-origin) * instance.T_model_mesh * Eigen::Translation3d(mesh.origin);
      placement = place(ret_traced->meshes[index], T_render_mesh);
      if (!is_placeable(placement)) continue;
      Eigen::Matrix<float, 3, 4> columns;
      columns << placement.linear, placement.translation;
      geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(geometry, scene_of_mesh[index]);
      rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
      rtcCommitGeometry(geometry);
    }
    const auto id = static_cast<unsigned>(ret_traced->placements.size());
    rtcAttachGeometryByID(top_, geometry, id);
    rtcReleaseGeometry(geometry);
    ret_traced->placements.push_back(placement);
  }
  ret_traced->top = top_;
  return check("adding the scene's meshes");
}

Status Accelerator::commit(const std::function<void(double)>& progress) {
  struct Watch {
    std::mutex mutex;
    const std::function<void(double)>* progress = nullptr;
    double before = 0.0;
    double share = 0.0;
    double shown = 0.0;
  } watch;
  watch.progress = &progress;
  const auto report = [](void* data, double part) {
    auto& w = *static_cast<Watch*>(data);
    const std::lock_guard lock(w.mutex);  // Embree calls from any of its threads.
    const double fraction = std::min(1.0, w.before + w.share * part);
    if (fraction > w.shown) (*w.progress)(w.shown = fraction);
    return true;
  };
  std::size_t total = top_triangles_;
  for (const Part& part : parts_) total += part.triangles;
  std::vector<Part> order = parts_;  // Parts first: the top-level BVH needs their bounds.
  order.push_back({top_, top_triangles_});
  for (const Part& part : order) {
    watch.share = static_cast<double>(part.triangles) / static_cast<double>(std::max<std::size_t>(total, 1));
    if (progress) rtcSetSceneProgressMonitorFunction(part.scene, report, &watch);
    rtcCommitScene(part.scene);
    if (progress) rtcSetSceneProgressMonitorFunction(part.scene, nullptr, nullptr);
    TRY(check("building the BVH"));
    watch.before += watch.share;
  }
  if (progress) progress(1.0);
  return Done{};
}

}  // namespace cyclorama
