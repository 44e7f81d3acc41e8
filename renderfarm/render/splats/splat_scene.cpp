// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/splats/splat_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/image/colour.h"
#include "renderfarm/render/splats/splat_harmonics.h"

namespace cyclorama::render {
namespace {

/// The point where a splat attenuates a ray. Events at equal distances are ordered by the splats' numbers.
struct Event {
  float distance;
  std::uint32_t splat;
  float alpha;

  [[nodiscard]] bool is_before(const Event& other) const {
    return distance != other.distance ? distance < other.distance : splat < other.splat;
  }
};

/// Number of events that one traversal collects. If it is small, rays through many splats need many traversals; if it
/// is large, sorting is slow.
constexpr std::size_t kEvents = 32;

/// Returns the distance from the centre, in standard deviations, beyond which a splat is left out.
float reach_of(float opacity) { return std::sqrt(2.0f * std::log(std::max(1.0f, opacity / kMinSplatAlpha))); }

}  // namespace

/// A ray on its way through the splats: it collects the nearest events after the last one that was used.
struct SplatScene::Ray {
  const SplatScene* scene;
  Vec3 origin;
  Vec3 direction;
  float far_m;
  Event last{-1.0f, 0, 0.0f};
  std::size_t count = 0;
  std::array<Event, kEvents> events;

  void collect(const Event& event) {
    if (count == kEvents && !event.is_before(events[count - 1])) return;
    std::size_t at = count < kEvents ? count++ : kEvents - 1;
    for (; at > 0 && event.is_before(events[at - 1]); --at) events[at] = events[at - 1];
    events[at] = event;
  }
};

void SplatScene::bounds_of(const RTCBoundsFunctionArguments* request) {
  const auto& self = *static_cast<const SplatScene*>(request->geometryUserPtr);
  const Record& record = self.records_[request->primID];
  // The rows of the inverse are the splat's axes, each times its standard deviation.
  const Eigen::Matrix3f axes = record.T_unit_render.inverse();
  constexpr float kRounding = 1.0001f;
  const Vec3 half = kRounding * reach_of(record.opacity) * axes.rowwise().norm();
  RTCBounds& bounds = *request->bounds_o;
  bounds.lower_x = record.centre.x() - half.x();
  bounds.lower_y = record.centre.y() - half.y();
  bounds.lower_z = record.centre.z() - half.z();
  bounds.upper_x = record.centre.x() + half.x();
  bounds.upper_y = record.centre.y() + half.y();
  bounds.upper_z = record.centre.z() + half.z();
}

void SplatScene::meet(const RTCIntersectFunctionNArguments* request) {
  if (request->valid[0] == 0) return;
  Ray& ray = *RayContext<Ray>::of(request->context);
  const Record& record = ray.scene->records_[request->primID];
  // The event is computed from the point of the ray that is nearest to the centre, so that distant splats lose no
  // precision.
  const Vec3 offset = ray.origin - record.centre;
  const float near_m = -offset.dot(ray.direction);
  const Vec3 start = record.T_unit_render * Vec3(offset + near_m * ray.direction);
  const Vec3 along = record.T_unit_render * ray.direction;
  const float further = -start.dot(along) / along.squaredNorm();
  const Event event{
      near_m + further, request->primID,
      std::min(kMaxSplatAlpha, record.opacity * std::exp(-0.5f * Vec3(start + further * along).squaredNorm()))};
  if (!(event.alpha >= kMinSplatAlpha) || !(event.distance > 0.0f) || !(event.distance < ray.far_m)) return;
  if (!ray.last.is_before(event)) return;
  ray.collect(event);
  // Boxes beyond the last event that is kept cannot contain an earlier event.
  if (ray.count == kEvents) {
    RTCRayN_tfar(RTCRayHitN_RayN(request->rayhit, request->N), request->N, 0) = ray.events[kEvents - 1].distance;
  }
}

void SplatScene::add_records(const scene::SplatCloud& cloud, const Eigen::Vector3d& origin) {
  const Eigen::Matrix3d linear = cloud.T_model_cloud.linear();
  const Eigen::Matrix3d inverse = linear.inverse();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::array<float, 4>& q = cloud.rotations[i];
    const Eigen::Matrix3d turn = Eigen::Quaternionf(q[0], q[1], q[2], q[3]).cast<double>().toRotationMatrix();
    const Eigen::Vector3d scale = Eigen::Vector3f(cloud.scales[i].data()).cast<double>();
    const Eigen::Vector3d p = cloud.origin + Eigen::Vector3f(cloud.positions[i].data()).cast<double>();
    Record record;
    record.centre = (cloud.T_model_cloud * p - origin).cast<float>();
    record.T_unit_render = (scale.cwiseInverse().asDiagonal() * turn.transpose() * inverse).cast<float>();
    record.opacity = cloud.opacities[i];
    record.cloud = static_cast<std::uint32_t>(clouds_.size());
    record.splat = static_cast<std::uint32_t>(i);
    const float volume = record.T_unit_render.determinant();
    if (is_finite(record.centre) && std::isnormal(volume) && std::isfinite(volume)) records_.push_back(record);
  }
  clouds_.push_back({&cloud, inverse.cast<float>()});
  is_linear_ = is_linear_ && cloud.is_linear;
}

Result<std::unique_ptr<SplatScene>> SplatScene::build(std::span<const scene::SplatCloud> clouds,
                                                      const Eigen::Vector3d& origin, RTCDevice device) {
  std::unique_ptr<SplatScene> built(new SplatScene());
  std::size_t count = 0;
  for (const scene::SplatCloud& cloud : clouds) count += cloud.size();
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    return Error(ErrorCode::kSystem, fmt::format("the scene has {} splats, which are more than Embree numbers", count));
  }
  built->records_.reserve(count);
  for (const scene::SplatCloud& cloud : clouds) built->add_records(cloud, origin);
  built->scene_ = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(built->records_.size()));
  rtcSetGeometryUserData(geometry, built.get());
  rtcSetGeometryBoundsFunction(
      geometry, [](const RTCBoundsFunctionArguments* request) { bounds_of(request); }, nullptr);
  rtcSetGeometryIntersectFunction(geometry, &SplatScene::meet);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(built->scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(built->scene_);
  if (const RTCError code = rtcGetDeviceError(device); code != RTC_ERROR_NONE) {
    return Error(ErrorCode::kSystem,
                 fmt::format("building the BVH of {} splats: Embree reports error {}{}", count, static_cast<int>(code),
                             code == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory" : ""));
  }
  return built;
}

SplatScene::~SplatScene() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
}

/// Returns the colour in the direction from the ray's start to the centre, as the original program computes it.
Vec3 SplatScene::colour_of(const Record& record, const Vec3& eye) const {
  const Cloud& cloud = clouds_[record.cloud];
  const std::size_t count = cloud.source->coefficient_count();
  const std::array<float, 3>* const coefficients = cloud.source->coefficients.data() + count * record.splat;
  const Vec3 direction = normalized_or(cloud.T_cloud_render * (record.centre - eye), Vec3::UnitZ());
  const auto harmonics = splat_harmonics(direction.x(), direction.y(), direction.z(), count);
  Vec3 colour = Vec3::Constant(0.5f);
  for (std::size_t k = 0; k < count; ++k) colour += harmonics[k] * to_vec3(coefficients[k]);
  colour = colour.cwiseMax(0.0f);
  if (cloud.source->is_linear == is_linear_) return colour;
  return {linear_to_srgb(colour.x()), linear_to_srgb(colour.y()), linear_to_srgb(colour.z())};
}

SplatLight SplatScene::trace(const Vec3& origin, const Vec3& direction, float far_m) const {
  SplatLight light;
  RayContext<Ray> context;
  Ray& ray = context.payload;
  ray.scene = this;
  ray.origin = origin;
  ray.direction = direction;
  ray.far_m = far_m;
  do {
    ray.count = 0;
    context.nearest(scene_, origin, direction, std::max(0.0f, ray.last.distance), far_m);
    for (std::size_t i = 0; i < ray.count; ++i) {
      const Event& event = ray.events[i];
      const float left = light.transmittance * (1.0f - event.alpha);
      if (left < kMinSplatTransmittance) return light;
      light.colour += light.transmittance * event.alpha * colour_of(records_[event.splat], origin);
      light.transmittance = left;
      if (left < 0.5f) light.depth_m = std::min(light.depth_m, event.distance);
      ray.last = event;
    }
  } while (ray.count == kEvents);
  return light;
}

}  // namespace cyclorama::render
