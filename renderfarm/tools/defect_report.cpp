// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/defect_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <system_error>

#include "common/base/file.h"
#include "common/image/draw.h"
#include "common/image/png.h"
#include "renderfarm/scene/scene.h"
#include "renderfarm/scene/scene_package.h"

namespace cyclorama::tools {
namespace {

using Eigen::Vector3d;

constexpr int kWidthPx = 640;
constexpr int kHeightPx = 480;
constexpr double kFieldRad = std::numbers::pi / 3.0;
constexpr int kSamples = 32;
constexpr std::size_t kMaxPackageBytes = std::size_t{1} << 20;

/// Returns a view from `eye` towards `at`.
render::PanoramaView view_towards(const Vector3d& eye, const Vector3d& at, int width_px, int height_px) {
  const Vector3d ahead = (at - eye).normalized();
  render::PanoramaView view;
  view.eye = eye;
  view.heading_rad = std::atan2(ahead.x(), -ahead.z());
  view.projection = Projection{
      Perspective::from_field(width_px, height_px, kFieldRad, std::asin(std::clamp(ahead.y(), -1.0, 1.0))), {}};
  return view;
}

/// Returns true if nothing hides the middle of the view within `distance`.
bool is_free(const render::Renderer& renderer, render::PanoramaView view, double distance) {
  view.depth = true;
  view.quality.bounces = 0;
  RgbImage picture;
  InverseDepthImage depth;
  const PixelRect all{0, 0, view.picture().width_px(), view.picture().height_px()};
  renderer.render(view, all, &picture, nullptr, &depth);
  constexpr double kHidden = 0.8;
  return double{inverse_metres(*depth.at(depth.width() / 2, depth.height() / 2))} * distance * kHidden < 1.0;
}

/// Returns an eye at this distance that sees the defect: before it, or from the side if something hides it there. Null
/// if it is hidden from everywhere.
std::optional<Vector3d> eye_at(double distance, const render::Renderer& renderer, const scene::Defect& defect) {
  const Vector3d across = defect.facing.unitOrthogonal();
  const Vector3d up = defect.facing.cross(across);
  constexpr int kSides = 8;
  for (const double slant : {0.0, 0.5, 1.0, -1.0}) {
    for (int side = 0; side < (slant == 0.0 ? 1 : kSides); ++side) {
      const double angle = 2.0 * std::numbers::pi * side / kSides;
      const Vector3d towards = (slant < 0.0 ? -1.0 : 1.0) * defect.facing +
                               std::abs(slant) * (std::cos(angle) * across + std::sin(angle) * up);
      const Vector3d eye = defect.middle + distance * towards.normalized();
      if (is_free(renderer, view_towards(eye, defect.middle, 12, 12), distance)) return eye;
    }
  }
  return std::nullopt;
}

/// Returns an eye that sees the defect and as much around it as shows where in the scene it is.
Vector3d eye_for(const render::Renderer& renderer, const scene::Defect& defect) {
  const double scene_m = renderer.scene().bounds.diagonal().norm();
  double distance = 0.0;
  for (const double share : {0.4, 0.15, 0.05, 0.01}) {
    distance = std::max({3.0 * defect.size_m, share * scene_m, 1e-3});
    if (const std::optional<Vector3d> eye = eye_at(distance, renderer, defect)) return *eye;
  }
  return defect.middle + distance * defect.facing;
}

void draw_ring(double radius_px, RgbImage* picture) {
  constexpr int kCorners = 64;
  const auto corner = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    return std::array{0.5 * kWidthPx + radius_px * std::cos(angle), 0.5 * kHeightPx + radius_px * std::sin(angle)};
  };
  for (int i = 0; i < kCorners; ++i) draw_line(picture, corner(i), corner(i + 1), {255, 40, 40}, 2);
}

}  // namespace

void print_defects(const scene::Defects& defects) {
  if (!defects.is_examined) {
    fmt::print("defects     not looked for: there are too many triangles\n");
    return;
  }
  const char* heading = "defects";
  for (const scene::DefectKind kind : scene::kDefectKinds) {
    const scene::Defects::Count& count = defects.count(kind);
    if (count.places == 0) continue;
    const auto largest = std::ranges::find(defects.largest, kind, &scene::Defect::kind);
    fmt::print("{:<12}{} {}, {} {}; the largest, {:.3g} m, at ({:.2f}, {:.2f}, {:.2f}); {}\n", heading, count.places,
               name_of(kind), count.triangles, kind == scene::DefectKind::kHole ? "edges" : "triangles",
               largest->size_m, largest->middle.x(), largest->middle.y(), largest->middle.z(),
               is_mended(kind) ? "--repair mends them" : "left as they are");
    heading = "";
  }
  if (*heading != '\0') fmt::print("defects     none\n");
}

Status draw_defects(const render::Renderer& renderer, const scene::Defects& defects,
                    const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("'{}': {}", folder.string(), error.message()));
  std::map<scene::DefectKind, int> drawn;
  for (const scene::Defect& defect : defects.largest) {
    const Vector3d eye = eye_for(renderer, defect);
    render::PanoramaView view = view_towards(eye, defect.middle, kWidthPx, kHeightPx);
    view.quality.samples = kSamples;
    view.quality.bounces = renderer.scene().bounces;
    RgbImage picture;
    renderer.render(view, {0, 0, kWidthPx, kHeightPx}, &picture, nullptr);
    const double px_per_radian = 0.5 * kWidthPx / std::tan(0.5 * kFieldRad);
    const double radius_px = px_per_radian * 0.6 * defect.size_m / (defect.middle - eye).norm();
    draw_ring(std::clamp(radius_px, 14.0, 0.45 * kHeightPx), &picture);
    std::string name(name_of(defect.kind));
    std::ranges::replace(name, ' ', '-');
    const std::filesystem::path file = folder / fmt::format("{}-{}.png", name, ++drawn[defect.kind]);
    TRY(write_png(file.string(), picture));
    fmt::print("            {}\n", file.string());
  }
  return Done{};
}

std::string with_repair(std::string_view text) {
  constexpr std::string_view kLine = "repair = true\n";
  std::string result;
  bool is_in_table = false;
  bool is_written = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view line = text.substr(at, end - at);
    at = end;
    const std::size_t first = line.find_first_not_of(" \t");
    const std::string_view content = first == std::string_view::npos ? std::string_view() : line.substr(first);
    if (content.starts_with('[')) {
      if (!is_written && !is_in_table) {
        result += kLine;
        is_written = true;
      }
      is_in_table = true;
    }
    const std::string_view key = content.substr(0, content.find_first_of(" \t="));
    if (!is_in_table && key == "repair") {
      result += kLine;
      is_written = true;
      continue;
    }
    result += line;
  }
  return result;
}

Status save_repair(const std::filesystem::path& scene) {
  std::error_code none;
  const std::filesystem::path file = std::filesystem::is_directory(scene, none) ? scene / "scene.toml" : scene;
  if (file.extension() != ".toml") {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is a geometry file: --repair needs a folder with it and a scene.toml that names it",
                             scene.string()));
  }
  TRY_ASSIGN(const std::string text, read_text_file(file, kMaxPackageBytes));
  const std::string repaired = with_repair(text);
  TRY(scene::parse_scene_package(repaired, file.string(), file.parent_path()));
  return write_file_atomically(file.string(), std::string_view(repaired));
}

}  // namespace cyclorama::tools
