// SPDX-License-Identifier: Apache-2.0
/// Measures how fast Embree alone traces the rays of a path tracer: raw_embree PACKAGE [--size WxH] [--samples N]
/// [--bounces N]. Prints one JSON object. One thread.
///
/// Cell by cell like the renderer (16x16 pixels, the samples of a pixel side by side, batches of 1024 paths), rays are
/// generated from the hits of the previous rays: camera, one shadow ray to a point on a lamp that the renderer might
/// choose, one cosine bounce, and so on; roulette ends paths as in the renderer. The rays are stored and then traced
/// again in that order while the time is measured: only Embree's calls and the copy of a ray into them.
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <ctime>
#include <numbers>
#include <string_view>
#include <vector>

#include "renderfarm/render/accelerator.h"
#include "renderfarm/render/bake.h"
#include "renderfarm/render/flush_denormals.h"
#include "renderfarm/render/shade.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {
namespace {

constexpr int kCell = 16;
constexpr int kBatch = 1024;
constexpr int kPacket = 16;
constexpr int kRounds = 3;
constexpr float kTanHalf = 0.7673270f;  ///< A field of view 75 degrees wide.

struct Ray {
  render::Vec3 origin;
  render::Vec3 direction;
  float far;
};

/// One stage of one batch: rays of one kind, traced together.
struct Group {
  enum class Kind { kCamera, kShadow, kBounce } kind;
  std::vector<Ray> rays;
  std::vector<render::Vec3> throughputs;  ///< Throughputs of the rays that paths follow, used while recording.
};

/// Numerical Recipes' generator; the measurement does not depend on its quality.
class Random {
 public:
  float operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<float>(state_ >> 40u) * 0x1p-24f;
  }

 private:
  std::uint64_t state_ = 1;
};

double thread_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

RTCRay as_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x();
  r.org_y = ray.origin.y();
  r.org_z = ray.origin.z();
  r.dir_x = ray.direction.x();
  r.dir_y = ray.direction.y();
  r.dir_z = ray.direction.z();
  r.tfar = ray.far;
  r.mask = ~0u;
  return r;
}

/// Hides the different interfaces of Embree 3 and 4 for the coherence hint.
class Calls {
 public:
  Calls(RTCScene scene, bool coherent) : scene_(scene) {
#if RTC_VERSION_MAJOR >= 4
    rtcInitIntersectArguments(&nearest_);
    rtcInitOccludedArguments(&any_);
    nearest_.flags = any_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
#else
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
  }
#if RTC_VERSION_MAJOR >= 4
  void nearest(RTCRayHit* ray) { rtcIntersect1(scene_, ray, &nearest_); }
  void any(RTCRay* ray) { rtcOccluded1(scene_, ray, &any_); }
  void nearest(const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene_, rays, &nearest_); }
  void any(const int* valid, RTCRay16* rays) { rtcOccluded16(valid, scene_, rays, &any_); }
#else
  void nearest(RTCRayHit* ray) { rtcIntersect1(scene_, &context_, ray); }
  void any(RTCRay* ray) { rtcOccluded1(scene_, &context_, ray); }
  void nearest(const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, scene_, &context_, rays); }
  void any(const int* valid, RTCRay16* rays) { rtcOccluded16(valid, scene_, &context_, rays); }
#endif

 private:
  RTCScene scene_;
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments nearest_;
  RTCOccludedArguments any_;
#else
  RTCIntersectContext context_;
#endif
};

RTCRayHit nearest(const render::TraceScene& scene, const Ray& ray) {
  RTCRayHit query{};
  query.ray = as_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  Calls(scene.top, false).nearest(&query);
  return query;
}

render::Vec3 cosine_around(const render::Vec3& n, Random& random) {
  const float sign = n.z() >= 0.0f ? 1.0f : -1.0f;
  const float a = -1.0f / (sign + n.z());
  const float b = n.x() * n.y() * a;
  const render::Vec3 t{1.0f + sign * n.x() * n.x() * a, sign * b, -sign * n.x()};
  const render::Vec3 s{b, sign + n.y() * n.y() * a, -n.y()};
  const float angle = 2.0f * std::numbers::pi_v<float> * random();
  const float r2 = random();
  const float r = std::sqrt(r2);
  return (r * std::cos(angle) * t + r * std::sin(angle) * s + std::sqrt(1.0f - r2) * n).normalized();
}

/// Generates the rays that follow from the hits of `stage`, as the renderer does at a matte surface.
void follow(const render::TraceScene& scene, const Group& stage, Random& random, Group* ret_shadow, Group* ret_bounce) {
  for (std::size_t i = 0; i < stage.rays.size(); ++i) {
    const Ray& ray = stage.rays[i];
    const RTCRayHit query = nearest(scene, ray);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    const bool is_lamp = query.hit.instID[0] == RTC_INVALID_GEOMETRY_ID && scene.lamps.holds(query.hit.geomID);
    if (is_lamp) continue;  // Lamps end paths.
    const render::SurfacePoint point = render::surface_at(render::triangle_at(scene, query.hit), ray.direction);
    const render::Vec3 start = render::start_off_surface(point, point.facing);
    const float choice = random();
    const render::Vec2 place{random(), random()};
    render::LightSample aim;
    if (scene.lights.sample(start, point.facing, choice, place, &aim) && point.facing.dot(aim.direction) > 0.0f)
      ret_shadow->rays.push_back({start, aim.direction, aim.distance});
    const render::Vec3 direction = cosine_around(point.facing, random);
    const render::Vec3 throughput = stage.throughputs[i].cwiseProduct(point.colour);
    const float chance = std::min(1.0f, render::kRouletteChance * throughput.maxCoeff());
    if (!(random() < chance)) continue;
    ret_bounce->rays.push_back({start, direction, std::numeric_limits<float>::infinity()});
    ret_bounce->throughputs.push_back(throughput / chance);
  }
}

struct Order {
  std::string package;
  int width = 480;
  int height = 270;
  int samples = 16;
  int bounces = 2;
};

std::vector<Group> record(const render::TraceScene& scene, const render::Vec3& eye, const Order& order) {
  std::vector<Group> groups;
  Random random;
  for (int cell = 0;; ++cell) {
    const int across = (order.width + kCell - 1) / kCell;
    const int x0 = cell % across * kCell;
    const int y0 = cell / across * kCell;
    if (y0 >= order.height) return groups;
    std::vector<Ray> camera;
    for (int y = y0; y < std::min(y0 + kCell, order.height); ++y) {
      for (int x = x0; x < std::min(x0 + kCell, order.width); ++x) {
        for (int s = 0; s < order.samples; ++s) {
          const float u = 2.0f * (static_cast<float>(x) + random()) / static_cast<float>(order.width) - 1.0f;
          const float v = (static_cast<float>(order.height) - 2.0f * (static_cast<float>(y) + random())) /
                          static_cast<float>(order.width);
          camera.push_back({eye, render::Vec3(u * kTanHalf, v * kTanHalf, -1.0f).normalized(),
                            std::numeric_limits<float>::infinity()});
        }
      }
    }
    for (std::size_t first = 0; first < camera.size(); first += kBatch) {
      const auto last = std::min(first + kBatch, camera.size());
      Group stage{
          Group::Kind::kCamera,
          {camera.begin() + static_cast<std::ptrdiff_t>(first), camera.begin() + static_cast<std::ptrdiff_t>(last)},
          std::vector<render::Vec3>(last - first, render::Vec3::Ones())};
      for (int bounce = 0;; ++bounce) {
        Group shadow{Group::Kind::kShadow, {}, {}};
        Group next{Group::Kind::kBounce, {}, {}};
        follow(scene, stage, random, &shadow, &next);
        stage.throughputs = {};
        groups.push_back(std::move(stage));
        groups.push_back(std::move(shadow));
        if (bounce == order.bounces) break;
        stage = std::move(next);
      }
    }
  }
}

/// Returns a sum over the results, so that no call is optimised away.
double trace_single(const render::TraceScene& scene, const Group& group) {
  Calls calls(scene.top, false);
  double sum = 0.0;
  for (const Ray& ray : group.rays) {
    RTCRayHit query;
    query.ray = as_embree(ray);
    if (group.kind == Group::Kind::kShadow) {
      calls.any(&query.ray);
    } else {
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      calls.nearest(&query);
    }
    sum += query.ray.tfar > 0.0f ? 1.0 : 0.0;
  }
  return sum;
}

double trace_packets(const render::TraceScene& scene, const Group& group) {
  Calls calls(scene.top, group.kind == Group::Kind::kCamera);
  double sum = 0.0;
  RTCRayHit16 query;
  for (std::size_t first = 0; first < group.rays.size(); first += kPacket) {
    render::alignas(64) std::array<int, kPacket> valid{};
    for (std::size_t lane = 0; lane < kPacket && first + lane < group.rays.size(); ++lane) {
      const Ray& ray = group.rays[first + lane];
      valid[lane] = -1;
      query.ray.org_x[lane] = ray.origin.x();
      query.ray.org_y[lane] = ray.origin.y();
      query.ray.org_z[lane] = ray.origin.z();
      query.ray.dir_x[lane] = ray.direction.x();
      query.ray.dir_y[lane] = ray.direction.y();
      query.ray.dir_z[lane] = ray.direction.z();
      query.ray.tnear[lane] = query.ray.time[lane] = 0.0f;
      query.ray.tfar[lane] = ray.far;
      query.ray.mask[lane] = ~0u;
      query.ray.flags[lane] = 0u;
      query.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    if (group.kind == Group::Kind::kShadow) {
      calls.any(valid.data(), &query.ray);
    } else {
      calls.nearest(valid.data(), &query);
    }
    for (std::size_t lane = 0; lane < kPacket; ++lane)
      if (valid[lane] != 0) sum += query.ray.tfar[lane] > 0.0f ? 1.0 : 0.0;
  }
  return sum;
}

struct Rates {
  std::array<double, 3> seconds{};
  std::array<double, 3> rays{};

  [[nodiscard]] double rate(std::size_t kind) const { return rays[kind] / seconds[kind] / 1e6; }
  [[nodiscard]] double all() const {
    return (rays[0] + rays[1] + rays[2]) / (seconds[0] + seconds[1] + seconds[2]) / 1e6;
  }
};

template <typename Trace>
double replay(const std::vector<Group>& groups, Rates* rates, Trace trace) {
  double sum = 0.0;
  for (const Group& group : groups) {
    const auto kind = static_cast<std::size_t>(group.kind);
    const double start = thread_seconds();
    sum += trace(group);
    rates->seconds[kind] += thread_seconds() - start;
    rates->rays[kind] += static_cast<double>(group.rays.size());
  }
  return sum;
}

Status measure(const Order& order) {
  TRY_ASSIGN(scene::Scene scene, scene::load_scene(order.package, scene::ImportLimits{}, nullptr));
  render::TraceScene traced;
  TRY_ASSIGN(const auto accelerator, render::Accelerator::build(scene, 2, nullptr, std::nullopt, &traced));
  const Eigen::Vector3d origin = render::render_origin(scene);
  if (traced.lights.empty()) return Error(ErrorCode::kInvalidArgument, "the scene has no lamps");
  const render::FlushDenormals flush;
  const std::vector<Group> groups = record(traced, (scene.info.start_eye - origin).cast<float>(), order);
  Rates single;
  Rates packets;
  double sum = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    // Each method traces all rays before the other does, so that neither finds the other's data in the caches.
    sum += replay(groups, &single, [&](const Group& group) { return trace_single(traced, group); });
    sum -= replay(groups, &packets, [&](const Group& group) { return trace_packets(traced, group); });
  }
  // Packets and single rays differ by rounding at edges.
  if (std::abs(sum) > 1e-4 * single.rays[0])
    return Error(ErrorCode::kSystem, fmt::format("packets and single rays differ in {} hits", sum));
  fmt::print(
      "{{\"mrays_per_cpu_s\": {:.3f}, \"camera\": {:.3f}, \"shadow\": {:.3f}, \"bounce\": {:.3f}, "
      "\"packets_mrays_per_cpu_s\": {:.3f}, \"packets_camera\": {:.3f}, \"packets_shadow\": {:.3f}, "
      "\"packets_bounce\": {:.3f}, \"rays\": {:.0f}}}\n",
      single.all(), single.rate(0), single.rate(1), single.rate(2), packets.all(), packets.rate(0), packets.rate(1),
      packets.rate(2), (single.rays[0] + single.rays[1] + single.rays[2]) / kRounds);
  return Done{};
}

bool read_option(std::string_view name, std::string_view value, Order* order) {
  const auto number = [](std::string_view text, int* ret) {
    return std::from_chars(text.data(), text.data() + text.size(), *ret).ec == std::errc{};
  };
  if (name == "--size") {
    const std::size_t cross = value.find('x');
    return cross != std::string_view::npos && number(value.substr(0, cross), &order->width) &&
           number(value.substr(cross + 1), &order->height);
  }
  if (name == "--samples") return number(value, &order->samples);
  return name == "--bounces" && number(value, &order->bounces);
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  Order order;
  bool good = argc >= 2 && argc % 2 == 0;
  if (good) order.package = argv[1];
  for (int i = 2; good && i < argc; i += 2) good = read_option(argv[i], argv[i + 1], &order);
  if (!good) {
    fmt::print(stderr, "usage: raw_embree PACKAGE [--size WxH] [--samples N] [--bounces N]\n");
    return 2;
  }
  if (const Status status = measure(order); !status) {
    fmt::print(stderr, "raw_embree: {}\n", status.error().message());
    return 1;
  }
  return 0;
}
