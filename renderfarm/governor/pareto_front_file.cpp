// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/pareto_front_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "common/config/config.h"

namespace cyclorama::governor {
namespace {

constexpr Range kCost = {1e-12, 1e12};
constexpr Range kError = {0.0, 1e12};

ParetoPoint read_point(ConfigTable table) {
  ParetoPoint point;
  point.cost = table.number("cpu_us_per_px", kCost);
  point.error = table.number("error", kError);
  render::PictureQuality& quality = point.quality;
  render::RenderQuality& render = quality.render;
  render.samples = table.integer("samples", {1, render::kMaxSamples}, render.samples);
  render.bounces = table.integer("bounces", {0, render::kMaxBounces}, render.bounces);
  render.light_samples = table.integer("light_samples", {1, render::kMaxLightSamples}, render.light_samples);
  render.firefly_limit = static_cast<float>(table.number("firefly_limit", {0, render::kMaxRadianceLimit}, 0.0));
  render.adaptive_error = static_cast<float>(table.number("adaptive_error", {0, render::kMaxRadianceLimit}, 0.0));
  render.adaptive_minimum = table.integer("adaptive_minimum", {2, render::kMaxSamples}, render.adaptive_minimum);
  render.stored_light = table.flag("stored_light", render.stored_light);
  quality.scale = table.number("scale", {render::kMinScale, 1}, quality.scale);
  quality.denoise = table.flag("denoise", quality.denoise);
  quality.jpeg_quality = table.integer("jpeg_quality", {1, 100}, quality.jpeg_quality);
  quality.subsample_chroma = table.flag("subsample_chroma", quality.subsample_chroma);
  return point;
}

Result<ParetoFront> front_of(Config config, const std::string& name) {
  std::vector<ParetoPoint> points;
  for (const ConfigTable& table : config.root().tables("point")) points.push_back(read_point(table));
  TRY(config.finish());
  if (points.empty()) {
    return Error(ErrorCode::kBadData,
                 fmt::format("{}: no [[point]]; 'cyclorama-bench-render trade SCENE' measures a front", name));
  }
  return ParetoFront::make(std::move(points));
}

}  // namespace

Result<ParetoFront> read_pareto_front(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return front_of(std::move(config), path.string());
}

Result<ParetoFront> parse_pareto_front(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  return front_of(std::move(config), name);
}

std::string pareto_front_text(const ParetoFront& front, std::string_view comment) {
  std::string text;
  while (!comment.empty()) {
    const std::size_t end = std::min(comment.find('\n'), comment.size());
    text += fmt::format("# {}\n", comment.substr(0, end));
    comment.remove_prefix(std::min(end + 1, comment.size()));
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    const render::PictureQuality& quality = front[i].quality;
    const render::RenderQuality& render = quality.render;
    fmt::format_to(
        std::back_inserter(text),
        "\n[[point]]\ncpu_us_per_px = {}\nerror = {}\nsamples = {}\nbounces = {}\nlight_samples = {}\n"
        "firefly_limit = {}\nadaptive_error = {}\nadaptive_minimum = {}\nstored_light = {}\nscale = {}\ndenoise = {}\n"
        "jpeg_quality = {}\nsubsample_chroma = {}\n",
        front[i].cost, front[i].error, render.samples, render.bounces, render.light_samples, render.firefly_limit,
        render.adaptive_error, render.adaptive_minimum, render.stored_light, quality.scale, quality.denoise,
        quality.jpeg_quality, quality.subsample_chroma);
  }
  return text;
}

}  // namespace cyclorama::governor
