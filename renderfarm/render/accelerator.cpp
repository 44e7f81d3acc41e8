// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/accelerator.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <mutex>

#include "renderfarm/render/alpha_filter.h"
#include "renderfarm/render/bake.h"
#include "renderfarm/render/requirements.h"

namespace cyclorama::render {
namespace {

/// Returns false for a flattened placement: Embree cannot invert its matrix, and it has no inside that a ray could
/// enter.
bool is_placeable(const Placement& placement) {
  const float volume = placement.linear.determinant();
  return std::isnormal(volume) && std::isfinite(1.0f / volume) && is_finite(placement.translation);
}

}  // namespace

Result<std::unique_ptr<Accelerator>> Accelerator::build(scene::Scene& scene, int threads,
                                                        const std::function<void(double)>& progress,
                                                        std::optional<MemoryMode> wanted, TraceScene* ret_traced) {
  std::unique_ptr<Accelerator> accelerator(new Accelerator());
  std::size_t triangles = 0;
  const std::vector<int> uses = uses_of_meshes(scene.model);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (uses[i] > 0) triangles += scene.model.meshes[i].triangles.size();
  }
  std::size_t splats = 0;
  for (const scene::SplatCloud& cloud : scene.model.splats) splats += cloud.size();
  if (triangles == 0 && splats == 0) {
    return Error(ErrorCode::kInvalidArgument,
                 "the scene has neither triangles nor splats, so there is nothing to render");
  }
  RenderNeed need{triangles, scene.model.instances.size(), 0, splats};
  for (const scene::Texture& texture : scene.model.textures) need.mip_bytes += mip_bytes(texture);
  accelerator->mode_ = wanted.value_or(MemoryMode::kFast);
  if (const std::optional<std::size_t> available = available_memory()) {
    TRY_ASSIGN(accelerator->mode_, choose_memory_mode(scene.info.title, need, *available, wanted));
    accelerator->limit_bytes_ = static_cast<std::int64_t>(memory_for_bvh(*available - need.mip_bytes));
  }
  const bool has_records = accelerator->mode_ == MemoryMode::kFast;
  if (has_records) accelerator->limit_bytes_ -= static_cast<std::int64_t>(triangles * sizeof(TriangleRecord));
  TRY(accelerator->open_device(threads));
  TRY(accelerator->add_meshes(scene, ret_traced));
  tbb::task_arena(threads > 0 ? threads : tbb::task_arena::automatic).execute([&] {
    for (std::size_t i = 0; i < uses.size(); ++i) {
      if (has_records && uses[i] > 0) ret_traced->meshes[i].records = make_triangle_records(scene.model.meshes[i]);
    }
  });
  ret_traced->textures.build(threads);
  TRY(accelerator->add_lights(scene, ret_traced));
  TRY(accelerator->commit(progress));
  if (splats > 0) {
    TRY_ASSIGN(accelerator->splats_, SplatScene::build(scene.model.splats, render_origin(scene), accelerator->device_));
    ret_traced->splats = accelerator->splats_.get();
  }
  return accelerator;
}

Accelerator::~Accelerator() {
  splats_.reset();
  if (top_ != nullptr) rtcReleaseScene(top_);
  if (panes_ != nullptr) rtcReleaseScene(panes_);
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
  top_ = new_scene();
  return check("making a scene");
}

RTCScene Accelerator::new_scene() const {
  const RTCScene scene = rtcNewScene(device_);
  rtcSetSceneFlags(
      scene, mode_ == MemoryMode::kCompact ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_ROBUST);
  return scene;
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
                   fmt::format("{}: out of memory: {} are in use and {} were free; take a coarser "
                               "scene or a machine with more memory",
                               doing, describe_bytes(bytes()), describe_bytes(static_cast<std::size_t>(limit_bytes_))));
    case RTC_ERROR_UNSUPPORTED_CPU:
      return Error(ErrorCode::kSystem,
                   fmt::format("{}: Embree does not support this processor (SSE2 is needed)", doing));
    default:
      return Error(ErrorCode::kSystem, fmt::format("{}: Embree reports error {}", doing, static_cast<int>(code)));
  }
}

RTCGeometry Accelerator::make_triangles(const scene::Mesh& mesh, SurfaceMesh* traced) {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                             sizeof(mesh.positions[0]), mesh.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(mesh.triangles[0]), mesh.triangles.size());
  rtcSetGeometryUserData(geometry, traced);
  if (traced->material->cut_out || traced->material->blends) {
    rtcSetGeometryIntersectFilterFunction(geometry, &alpha_filter);
    rtcSetGeometryOccludedFilterFunction(geometry, &alpha_filter);
  }
  // cross_panes() computes afterwards how panes attenuate shadow rays.
  if (traced->material->pane) rtcSetGeometryOccludedFilterFunction(geometry, &pass_all_filter);
  rtcCommitGeometry(geometry);
  return geometry;
}

void Accelerator::add_mesh(const scene::Model& model, scene::Mesh& mesh, int uses, TraceScene* ret_traced) {
  // Embree reads the last vertex with a 16-byte load, so the four bytes after it must be readable.
  mesh.positions.reserve(mesh.positions.size() + 1);
  ret_traced->meshes.push_back(trace_mesh(mesh));
  SurfaceMesh& traced = ret_traced->meshes.back();
  const auto material = static_cast<std::size_t>(mesh.material);
  traced.material = &ret_traced->materials[material];
  if (blends(model.materials[material], mesh, see_through_)) {
    ret_traced->materials.push_back(*traced.material);
    ret_traced->materials.back().blends = true;
    traced.material = &ret_traced->materials.back();
  }
  part_of_mesh_.push_back(nullptr);
  if (uses < 2 || mesh.triangles.empty()) return;
  const RTCScene part = new_scene();
  const RTCGeometry geometry = make_triangles(mesh, &traced);
  rtcAttachGeometry(part, geometry);
  rtcReleaseGeometry(geometry);
  part_of_mesh_.back() = part;
  parts_.push_back({part, mesh.triangles.size()});
}

void Accelerator::add_instance(scene::Model& model, scene::Instance& instance, const Eigen::Vector3d& origin,
                               TraceScene* ret_traced) {
  const auto index = static_cast<std::size_t>(instance.mesh);
  scene::Mesh& mesh = model.meshes[index];
  SurfaceMesh& traced = ret_traced->meshes[index];
  if (mesh.triangles.empty()) return;
  Placement placement;
  RTCGeometry geometry = nullptr;
  if (part_of_mesh_[index] == nullptr) {
    bake(mesh, instance.T_model_mesh, origin);
    instance.T_model_mesh = Eigen::Affine3d::Identity();
    placement.mesh = &traced;
    geometry = make_triangles(mesh, &traced);
    top_triangles_ += mesh.triangles.size();
  } else {
    placement =
        place(traced, Eigen::Translation3d(-origin) * instance.T_model_mesh * Eigen::Translation3d(mesh.origin));
    if (!is_placeable(placement)) return;
    Eigen::Matrix<float, 3, 4> columns;
    columns << placement.linear, placement.translation;
    geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, part_of_mesh_[index]);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(geometry);
  }
  rtcAttachGeometryByID(top_, geometry, static_cast<unsigned>(ret_traced->placements.size()));
  if (traced.material->pane) add_pane(geometry, ret_traced);
  rtcReleaseGeometry(geometry);
  ret_traced->placements.push_back(placement);
}

void Accelerator::add_pane(RTCGeometry geometry, TraceScene* ret_traced) {
  if (panes_ == nullptr) {
    panes_ = new_scene();
    ret_traced->panes = panes_;
  }
  rtcAttachGeometryByID(panes_, geometry, static_cast<unsigned>(ret_traced->placements.size()));
}

Status Accelerator::add_meshes(scene::Scene& scene, TraceScene* ret_traced) {
  scene::Model& model = scene.model;
  const Eigen::Vector3d origin = render_origin(scene);
  const std::vector<int> uses = uses_of_meshes(model);
  see_through_ = see_through_textures(model);
  // Reserved, because the tables point to each other. A material that blends only on some meshes is stored twice.
  ret_traced->materials.reserve(model.materials.size() + model.meshes.size());
  ret_traced->meshes.reserve(model.meshes.size());
  for (const scene::Material& material : model.materials) {
    ret_traced->materials.push_back(trace_material(model, material, &ret_traced->textures));
  }
  for (std::size_t i = 0; i < model.meshes.size(); ++i) add_mesh(model, model.meshes[i], uses[i], ret_traced);
  for (scene::Instance& instance : model.instances) add_instance(model, instance, origin, ret_traced);
  ret_traced->top = top_;
  return check("adding the scene's meshes");
}

Status Accelerator::add_lights(const scene::Scene& scene, TraceScene* ret_traced) {
  ret_traced->lights =
      LightSet(scene.model.lights, render_origin(scene), ret_traced->placements, scene.sky, scene.environment);
  ret_traced->lamps =
      attach_lamps(ret_traced->lights, static_cast<unsigned>(ret_traced->placements.size()), device_, top_);
  return check("adding the scene's lamps");
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
  std::vector<Part> order = parts_;  // Parts first, because the top-level BVH needs their bounds.
  order.push_back({top_, top_triangles_});
  if (panes_ != nullptr) order.push_back({panes_, 0});
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

}  // namespace cyclorama::render
