// SPDX-License-Identifier: Apache-2.0
/// A node's interface to a ray tracer. Production code adapts Renderer (renderfarm/render); tests draw patterns.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/inverse_depth.h"
#include "common/image/pixel_rect.h"
#include "common/wire/farm.pb.h"
#include "renderfarm/governor/refinement.h"
#include "renderfarm/node/light_versions.h"
#include "renderfarm/render/film.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::node {

/// Computes one part of a denoised picture. Thread-bound.
class DenoisedWork {
 public:
  virtual ~DenoisedWork() = default;
  /// Continues until the part is done or `stop` returns true. `stop` is called every few milliseconds, from any thread.
  /// Returns the cost of this call. `ret_light` is unchanged until the part is done; it then has the part's size, and
  /// BlockRenderer::developed() gives its pixels. `ret_depth` then has the size of the part's cells; it stays empty
  /// unless the view requests depth.
  virtual render::RenderCost advance(const std::function<bool()>& stop, RadianceImage* ret_light,
                                     InverseDepthImage* ret_depth) = 0;

 protected:
  DenoisedWork() = default;
  DenoisedWork(const DenoisedWork&) = default;
  DenoisedWork& operator=(const DenoisedWork&) = default;
};

/// One loaded scene. The same view gives the same pixels on any node, however it is cut into blocks. Several threads
/// may render at once, each pictures of its own; the light that a view reads is in the view. Thread-safe.
class BlockRenderer {
 public:
  virtual ~BlockRenderer() = default;
  /// Prepares to render and denoise `rect`; DenoisedWork::advance() does the work. Denoising needs a margin around each
  /// rect, so one large rect costs less than its tiles. The result must not outlive the renderer.
  [[nodiscard]] virtual std::unique_ptr<DenoisedWork> begin_denoised(const render::PanoramaView& view,
                                                                     const PixelRect& rect) = 0;
  /// Renders the given samples of the view into `film`, whatever number of samples the view requests. `film` must have
  /// the rect's size, no features, and the cells' depth if the view requests it. `cancelled` is called before each
  /// cell, from any thread. Cells that already have samples are left unchanged, so a cancelled film can be continued.
  /// Sums of films of the same ranges, added in the same order, are bit-identical on any node.
  virtual render::RenderCost render_film(const render::PanoramaView& view, const PixelRect& rect,
                                         const governor::SampleRange& samples, render::Film* film,
                                         const std::function<bool()>& cancelled) = 0;
  /// Returns the pixels that Renderer::render() would produce from a film with this mean, bit for bit.
  [[nodiscard]] virtual RgbImage developed(const RadianceImage& mean) const = 0;
  /// Returns the description of the scene without its name, which the coordinator assigns.
  [[nodiscard]] virtual wire::SceneDescription description() const = 0;
  /// Returns one sentence about the parts of the scene that could not be used; empty if there are none.
  [[nodiscard]] virtual std::string note() const = 0;
  /// Returns true if the scene's light can be computed ahead.
  [[nodiscard]] virtual bool can_have_light() const { return false; }
  /// Reads a file of stored light (renderfarm/light/light_file.h), checks that it belongs to this scene, and keeps it
  /// under its version beside the previous one. May take seconds. `name` identifies the file in errors. Thread-safe.
  /// Errors: those of light_file.h.
  virtual Result<VersionedLight> add_light(std::span<const std::byte> file, std::string_view name) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("{}: this renderer uses no stored light ({} bytes)", name, file.size()));
  }
  /// Returns the versions of the scene's light; null if the renderer uses no stored light. Thread-safe.
  [[nodiscard]] virtual const LightVersions* light_versions() const { return nullptr; }
  [[nodiscard]] virtual std::uint64_t memory_bytes() const = 0;
  /// Returns the number of bounces in the scene's reference picture.
  [[nodiscard]] virtual int bounces() const = 0;
  /// Returns the thread time per megapixel of a small fixed picture from the scene's start: a measure of the host's
  /// speed.
  [[nodiscard]] virtual double probe_cpu_seconds() = 0;

 protected:
  BlockRenderer() = default;
  BlockRenderer(const BlockRenderer&) = default;
  BlockRenderer& operator=(const BlockRenderer&) = default;
};

/// Makes a BlockRenderer from a path on the node's disk; `progress` takes a fraction in [0, 1] and is never null. Each
/// error is one sentence with file, place and remedy. May throw std::bad_alloc, which SceneStore turns into an error.
using SceneLoader = std::function<Result<std::unique_ptr<BlockRenderer>>(const std::string& path,
                                                                         const std::function<void(double)>& progress)>;

}  // namespace cyclorama::node
