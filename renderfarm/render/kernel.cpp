// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderfarm/render/sample_batch.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/shade.h"
#include "renderfarm/render/splats/cross_splats.h"
#include "renderfarm/render/stored_light_stage.h"

namespace cyclorama::render {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
/// Start of camera rays. Excludes only the distance 0, so that an eye exactly in a lamp's plane does not see the lamp's
/// black back.
constexpr float kNotAtTheEye = 1e-30f;
/// Maximum number of samples of a pixel that are traced together: one packet.
constexpr int kMaxPacketSamples = kPacketRays;

constexpr std::uint32_t even_bits(std::uint32_t v) {
  v &= 0x55555555u;
  v = (v | (v >> 1)) & 0x33333333u;
  return (v | (v >> 2)) & 0x0f0f0f0fu;
}

struct CellPlace {
  int x = 0;
  int y = 0;
};

/// Returns pixel number `i` of a cell in Z-order: neighbours in the list are neighbours in the picture, so packets are
/// squares.
CellPlace place_in_order(int i) {
  const auto bits = static_cast<std::uint32_t>(i);
  return {static_cast<int>(even_bits(bits)), static_cast<int>(even_bits(bits >> 1))};
}

int sequence_length(const RenderQuality& quality) {
  return std::max(quality.sequence, quality.first_sample + quality.samples);
}

void add_path(const TraceView& view, const TraceCell& cell, CellPlace place, int sample, PathBatch& batch) {
  const SampleSequence sequence(view.seed, cell.x + place.x, cell.y + place.y, sample, sequence_length(view.quality));
  const auto i = static_cast<std::size_t>(batch.paths++);
  Path& path = batch.path[i];
  path = Path{};
  path.index_reversed = sequence.index_reversed();
  path.seed = sequence.seed();
  path.pixel = place.y * kCellPx + place.x;
  batch.index_reversed[i] = path.index_reversed;
  batch.seed[i] = path.seed;
}

/// Generates the camera rays of the paths. Pixels outside a fisheye's circle have none.
void generate_camera_rays(const TraceView& view, const TraceCell& cell, PathBatch& batch) {
  SurfaceRandomNumbers& random_numbers = batch.random_numbers;
  if (cell.middle) {
    std::fill_n(random_numbers.place_u.begin(), batch.paths, 0.5f);
    std::fill_n(random_numbers.place_v.begin(), batch.paths, 0.5f);
  } else {
    sample_pairs(batch.paths, batch.index_reversed.data(), batch.seed.data(), kPixelPlace,
                 random_numbers.place_u.data(), random_numbers.place_v.data());
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.paths); ++i) {
    random_numbers.place_u[i] += static_cast<float>(cell.x + batch.path[i].pixel % kCellPx);
    random_numbers.place_v[i] += static_cast<float>(cell.y + batch.path[i].pixel / kCellPx);
  }
  EyeRays& eyes = batch.eye_rays;
  view.camera.rays(batch.paths, random_numbers.place_u.data(), random_numbers.place_v.data(),
                   {eyes.origin[0].data(), eyes.origin[1].data(), eyes.origin[2].data(), eyes.direction[0].data(),
                    eyes.direction[1].data(), eyes.direction[2].data(), eyes.cone.data(), eyes.exists.data()});
  // A sample's footprint is the pixel's divided by the square root of the number of samples, so many samples show
  // textures at full sharpness.
  const float share = cell.middle ? 1.0f : 1.0f / std::sqrt(static_cast<float>(sequence_length(view.quality)));
  RayStage& stage = batch.current();
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.paths); ++i) {
    if (eyes.exists[i] == 0) continue;
    const int slot = stage.rays.count();
    PathRay& ray = stage.state[static_cast<std::size_t>(slot)];
    ray = PathRay{};
    ray.path = static_cast<std::uint16_t>(i);
    ray.cone_spread = share * eyes.cone[i];
    stage.rays.add(view.eye + Vec3(eyes.origin[0][i], eyes.origin[1][i], eyes.origin[2][i]),
                   {eyes.direction[0][i], eyes.direction[1][i], eyes.direction[2][i]}, kFar,
                   alpha_random_number(batch.path[i].index_reversed, batch.path[i].seed, 0));
    stage.rays.packet(slot).ray.tnear[slot % kPacketRays] = kNotAtTheEye;
  }
}

/// Records the distances of the first surfaces that the camera rays hit, whether they are mirrors, glass or opaque.
void note_depth(PathBatch& batch, CellFilm& film) {
  const RayStage& stage = batch.current();
  for (int i = 0; i < stage.rays.count(); ++i) {
    const auto pixel = static_cast<std::size_t>(batch.path[stage.state[static_cast<std::size_t>(i)].path].pixel);
    const std::size_t row = pixel / (kCellPx * kDepthCellPx);
    const std::size_t column = pixel % kCellPx / kDepthCellPx;
    float& nearest_m = film.nearest_m[row * kDepthsPerSide + column];
    nearest_m = std::min(nearest_m, stage.rays.distance(i));  // Infinite where there is no hit.
  }
}

/// Adds the paths' light to their pixels in the order of the paths, so the sums do not depend on how a picture is
/// divided.
void collect(const TraceView& view, const PathBatch& batch, CellFilm& film) {
  const float limit = view.quality.firefly_limit / view.exposure;
  const float brightest = kBrightest / std::max(1.0f, view.exposure);
  for (int i = 0; i < batch.paths; ++i) {
    const Path& path = batch.path[static_cast<std::size_t>(i)];
    Vec3 direct = path.direct;
    Vec3 indirect = path.indirect.cwiseMin(brightest);
    if ((path.direct + path.indirect).hasNaN()) {
      direct.setZero();
      indirect.setZero();
      ++film.broken_samples;
    }
    if (limit > 0.0f) {
      const float bright = luminance(indirect);
      if (bright > limit) {
        indirect *= limit / bright;
        film.removed_light += static_cast<double>(bright) - static_cast<double>(limit);
      }
    }
    const Vec3 radiance = (direct + indirect).cwiseMin(brightest);
    const auto pixel = static_cast<std::size_t>(path.pixel);
    const float bright = luminance(radiance);
    film.sum[pixel] += radiance;
    film.square[pixel] += bright * bright;
    ++film.samples[pixel];
    film.light += static_cast<double>(bright);
  }
}

void trace_batch(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                 PathBatch& batch, CellFilm& film) {
  generate_camera_rays(view, cell, batch);
  trace_paths(scene, shade, view, Coherence::kCoherent, batch, film);
  collect(view, batch, film);
  batch.paths = 0;
}

}  // namespace

void trace_paths(const TraceScene& scene, ShadeStage shade, const TraceView& view, Coherence first, PathBatch& batch,
                 CellFilm& film) {
  for (Coherence coherence = first; batch.current().rays.count() > 0; coherence = Coherence::kIncoherent) {
    RayQueue<RTCRayHit16>& rays = batch.current().rays;
    trace_nearest(scene.top, coherence, rays);
    batch.rays_traced += static_cast<std::uint64_t>(rays.count());
    const bool is_camera = coherence == Coherence::kCoherent;  // Only camera rays are coherent.
    if (view.depth && is_camera) note_depth(batch, film);
    if (scene.splats != nullptr) cross_splats(scene, view, is_camera, batch, film);
    if (ends_at_stored_light(view)) end_at_stored_light(scene, view, batch);
    if (rays.count() > 0) {
      draw_random_numbers(batch);
      shade(scene, view, batch, film);
    }
    rays.clear();
    batch.stage = 1 - batch.stage;
  }
}

void CellFilm::clear() {
  sum.fill(Vec3::Zero());
  square.fill(0.0f);
  samples.fill(0);
  albedo.fill(Vec3::Zero());
  normal.fill(Vec3::Zero());
  distance.fill(0.0f);
  active.fill(true);
  lacks_light.fill(false);
  nearest_m.fill(kFar);
  light = 0.0;
  removed_light = 0.0;
  broken_samples = 0;
}

void CellFilm::restart_active() {
  for (std::size_t pixel = 0; pixel < active.size(); ++pixel) {
    if (!active[pixel]) continue;
    light -= static_cast<double>(luminance(sum[pixel]));
    sum[pixel].setZero();
    square[pixel] = 0.0f;
    samples[pixel] = 0;
    albedo[pixel].setZero();
    normal[pixel].setZero();
    distance[pixel] = 0.0f;
  }
}

std::uint64_t trace_cell(const TraceScene& scene, ShadeStage shade, const TraceView& view, const TraceCell& cell,
                         PathBatch& batch, CellFilm& film) {
  batch.paths = 0;
  for (RayStage& stage : batch.stages) stage.rays.clear();
  batch.shadow_rays.clear();
  batch.rays_traced = 0;
  const int end = cell.first_sample + cell.samples;
  for (int sample = cell.first_sample; sample < end; sample += kMaxPacketSamples) {
    const int together = std::min(kMaxPacketSamples, end - sample);
    for (int i = 0; i < kCellPixels; ++i) {
      const CellPlace place = place_in_order(i);
      const auto pixel = static_cast<std::size_t>(place.y * kCellPx + place.x);
      if (place.x >= cell.width || place.y >= cell.height || !film.active[pixel]) continue;
      if (batch.paths + together > kMaxRays) trace_batch(scene, shade, view, cell, batch, film);
      for (int s = 0; s < together; ++s) add_path(view, cell, place, sample + s, batch);
    }
    trace_batch(scene, shade, view, cell, batch, film);
  }
  return batch.rays_traced;
}

}  // namespace cyclorama::render
