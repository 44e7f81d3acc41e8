// SPDX-License-Identifier: Apache-2.0
// Shows a scene on a room's wall without a farm, a network or a graphics card: the ray tracer renders the picture that
// installation.toml requires, each projector's picture is warped and blended in double precision, and the simulated
// room is photographed.
#include <fmt/format.h>

#include <numbers>

#include "common/base/file.h"
#include "common/geometry/guard_band.h"
#include "common/image/jpeg.h"
#include "common/image/png.h"
#include "common/process/program.h"
#include "drivers/simulated/room/room_picture.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"
#include "tests/support/warped_picture.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr JpegOptions kJpeg{82, true};

struct Options {
  std::string scene;
  std::string installation;
  std::string out;
  int width_px = 1024;
  int samples = 4;
  double turn_deg = 0.0;
};

Result<RgbImage> traced(const Options& options, const PictureShape& shape) {
  TRY_ASSIGN(scene::Scene scene, scene::load_scene(options.scene, {}, nullptr));
  render::PanoramaView view;
  view.eye = scene.info.start_eye;
  view.heading_rad = scene.info.start_heading_rad;
  view.projection = Projection{shape, {}};
  view.quality.samples = options.samples;
  view.quality.bounces = scene.bounces;
  TRY_ASSIGN(const std::unique_ptr<render::Renderer> renderer, render::Renderer::build(std::move(scene), 0, nullptr));
  RgbImage picture;
  renderer->render(view, {0, 0, width_px(shape), height_px(shape)}, &picture, nullptr);
  return picture;
}

Status run(const Options& options, const StopSignal&) {
  TRY_ASSIGN(const Installation room, read_installation(options.installation));
  const PictureShape wanted = room.picture(options.width_px);
  const PictureShape shape = with_guard_band(wanted, std::abs(options.turn_deg) * kDegree);
  TRY_ASSIGN(const RgbImage picture, traced(options, shape));
  const WarpedPicture warped(picture, shape, options.turn_deg * kDegree);
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(room);
  const std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
  std::vector<RgbImage> heads;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    TRY_ASSIGN(const warp::Warp warp, warp::make_warp(maps[i], wanted));
    RgbImage& head = heads.emplace_back(width_px(warp), height_px(warp));
    for (int y = 0; y < head.height(); ++y) {
      for (int x = 0; x < head.width(); ++x) {
        const auto codes = warped.at(warp, masks[i], x, y);
        for (std::size_t c = 0; c < 3; ++c) head.at(x, y)[c] = static_cast<std::uint8_t>(codes[c] + 0.5);
      }
    }
    if (const warp::WarpMesh* const mesh = std::get_if<warp::WarpMesh>(&warp)) {
      fmt::print("{}: {} x {} cells, {} cut, {} vertices, off by {:.3f} px at most\n", room.projectors[i].name,
                 mesh->cells_x, mesh->cells_y, mesh->cuts.size(), mesh->vertices.size(), mesh->worst_error_px);
    } else if (const warp::WarpPatches* const patches = std::get_if<warp::WarpPatches>(&warp)) {
      fmt::print("{}: {} x {} patches, off by {:.3f} px at most\n", room.projectors[i].name, patches->across(),
                 patches->down(), patches->worst_error_px);
    } else {
      fmt::print("{}: a map of each pixel\n", room.projectors[i].name);
    }
  }
  const RgbImage photo =
      simulated::RoomPicture(room, simulated::RoomEye::behind_visitor(room, 960, 540)).photograph(heads);
  JpegEncoder encoder;
  TRY_ASSIGN(const std::vector<std::byte> jpeg, encoder.encode(photo, kJpeg));
  TRY(write_file_atomically(options.out + ".jpg", jpeg));
  TRY_ASSIGN(const std::vector<std::byte> asked, encoder.encode(picture, kJpeg));
  return write_file_atomically(options.out + "-picture.jpg", asked);
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  Program program("test-screens", "What a room's wall shows of a scene, made on this machine alone.");
  Options options;
  CLI::App& app = program.options();
  app.add_option("--scene", options.scene, "A scene package, .glb, .gltf, .ply or .obj")->required();
  app.add_option("--installation", options.installation, "The room")->required();
  app.add_option("--out", options.out, "PATH.jpg is the room, PATH-picture.jpg what was asked of the ray tracer")
      ->required();
  app.add_option("--width", options.width_px, "Of the picture")->check(CLI::Range(16, 8192))->capture_default_str();
  app.add_option("--samples", options.samples, "Per pixel")->check(CLI::Range(1, 4096))->capture_default_str();
  app.add_option("--turn-deg", options.turn_deg,
                 "How far the visitor has turned to the right since the picture was made")
      ->check(CLI::Range(-20.0, 20.0))
      ->capture_default_str();
  return program.run(argc, argv, [&](const StopSignal& stop) { return run(options, stop); });
}
