// SPDX-License-Identifier: Apache-2.0
// The display's figures: display_bench exact|blit|trade|decode FILE|tiles FOLDER. Times are processor time of all
// threads, including the software rasteriser's. Compared variants take turns, and a ratio is the median over the turns.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/base/file.h"
#include "common/geometry/picture_place.h"
#include "common/image/png.h"
#include "tests/support/painted_head.h"

namespace cyclorama {
namespace {

using Json = nlohmann::json;

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
double middle(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}
template <typename T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message());
  return *std::move(result);
}
void must(const Status& status) {
  if (!status) throw std::runtime_error(status.error().message());
}

/// A round room with three projectors of full HD: a larger version of the demo's.
Installation hall() {
  Installation room = must(parse_installation(R"(
name = "Hall"
[wall]
shape = "cylinder"
radius_m = 3.0
arc_deg = 126
bottom_m = 0.9
top_m = 2.6
[visitor]
eye_m = [0.0, 1.65, 0.0]
[[projector]]
name = "left"
width_px = 1920
height_px = 1080
field_of_view_deg = 60
lens_shift_fraction = [0.0, -0.5]
position_m = [0.15, 2.75, 0.4]
pan_deg = -45
[[projector]]
name = "middle"
width_px = 1920
height_px = 1080
field_of_view_deg = 60
lens_shift_fraction = [0.0, -0.5]
position_m = [0.0, 2.75, 0.4]
[[projector]]
name = "right"
width_px = 1920
height_px = 1080
field_of_view_deg = 60
lens_shift_fraction = [0.0, -0.5]
position_m = [-0.15, 2.75, 0.4]
pan_deg = 45
)",
                                              "hall"));
  return room;
}

RgbImage picture_of(const Panorama& panorama) {
  RgbImage picture(panorama.width_px, panorama.height_px);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double checks = (x / 64 + y / 64) % 2 == 0 ? 40.0 : 0.0;
      picture.at(x, y)[0] = static_cast<std::uint8_t>(110.0 + 70.0 * std::sin(x * 0.011) + checks);
      picture.at(x, y)[1] = static_cast<std::uint8_t>(110.0 + 70.0 * std::sin(y * 0.017 + x * 0.003) + checks);
      picture.at(x, y)[2] = static_cast<std::uint8_t>(110.0 + 70.0 * std::cos(x * 0.007) + checks);
    }
  }
  return picture;
}

/// The hall's heads on one output, and everything that draws them.
class Bench {
 public:
  explicit Bench(int panorama_px, double tolerance_px = 0.05) : room_(hall()), panorama_(room_.panorama(panorama_px)) {
    std::vector<output::HeadMode> modes;
    const std::vector<warp::ProjectorMap> maps = warp::projector_maps(room_);
    const std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
    for (std::size_t i = 0; i < maps.size(); ++i) {
      modes.push_back({room_.projectors[i].name, 1920, 1080});
      plans.push_back({must(warp::make_warp(maps[i], panorama_, tolerance_px)), masks[i]});
    }
    output = must(output::open_headless_output({modes, 1000.0, {}, output::HeadlessOptions::Renderer::kAny}, clock_));
    programs.emplace(gl());
    frame = PaintedHead::frame(JpegEncoder().to_planar(picture_of(panorama_)), panorama_, nullptr);
    for (const display::Texels texels : {display::Texels::kHalves, display::Texels::kPacked}) {
      picture_programs_.push_back(
          std::make_unique<display::PictureProgram>(must(display::PictureProgram::make(gl(), texels))));
      textures_.push_back(std::make_unique<display::PanoramaTexture>(gl(), *picture_programs_.back()));
      must(textures_.back()->upload(frame));
    }
  }
  const output::Gl& gl() const { return output->gl(); }
  const Panorama& panorama() const { return panorama_; }
  const Installation& room() const { return room_; }
  std::vector<display::HeadPainter> painters(const std::vector<display::HeadPlan>& of) {
    std::vector<display::HeadPainter> made;
    for (const display::HeadPlan& plan : of) {
      made.push_back(must(display::HeadPainter::make(gl(), &*programs, plan, display::texels_for(gl(), of))));
    }
    return made;
  }
  /// Returns the texture in the texel format that a display with these heads would choose.
  display::PanoramaTexture& texture_for(const std::vector<display::HeadPlan>& of) {
    return *textures_[display::texels_for(gl(), of) == display::Texels::kPacked ? 1 : 0];
  }
  void draw(const std::vector<display::HeadPainter>& painters, const display::PanoramaTexture& shown) {
    for (std::size_t i = 0; i < painters.size(); ++i) {
      must(output->draw_to(i));
      painters[i].draw({&shown, 0.05});
    }
    gl().Finish();
  }
  /// The same pixels with another shape.
  std::unique_ptr<display::PanoramaTexture> texture_of(const PictureShape& shape) {
    const bool is_packed = display::texels_for(gl(), plans) == display::Texels::kPacked;
    auto made = std::make_unique<display::PanoramaTexture>(gl(), *picture_programs_[is_packed ? 1 : 0]);
    display::DisplayFrame other = frame;
    other.shape = with_pixels(shape, panorama_.width_px, panorama_.height_px);
    must(made->upload(other));
    return made;
  }
  template <typename Draw>
  static double timed(const Draw& draw) {
    const double start = cpu_s();
    draw();
    return cpu_s() - start;
  }

  std::vector<display::HeadPlan> plans;
  std::unique_ptr<output::Output> output;
  std::optional<display::HeadPrograms> programs;
  display::DisplayFrame frame;

 private:
  SteadyClock clock_;
  Installation room_;
  Panorama panorama_;
  // One for half floats, one for packed texels.
  std::vector<std::unique_ptr<display::PictureProgram>> picture_programs_;
  std::vector<std::unique_ptr<display::PanoramaTexture>> textures_;
};

/// Reference for the cost of pass 2: the same pixels, each only a bilinear sample of an 8-bit picture.
class Blit {
 public:
  explicit Blit(Bench* bench) : bench_(*bench), texture_(bench->gl()), array_(bench->gl()) {
    const output::Gl& gl = bench_.gl();
    const RgbImage picture = picture_of(bench_.panorama());
    RgbaImage pixels(picture.width(), picture.height(), 255);
    for (std::size_t i = 0; i < picture.data().size(); ++i) pixels.data()[i / 3 * 4 + i % 3] = picture.data()[i];
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, texture_.id());
    for (const int wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      gl.TexParameteri(GL_TEXTURE_2D, static_cast<GLenum>(wrap), GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, pixels.width(), pixels.height(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  pixels.data().data());
    program_.emplace(must(output::GlProgram::link(gl, R"(#version 300 es
precision highp float;
uniform vec2 from;
out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  at = vec2(mix(from.x, from.y, corner.x), corner.y);
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
)",
                                                  R"(#version 300 es
precision highp float;
uniform sampler2D picture;
in vec2 at;
out vec4 colour;
void main() { colour = texture(picture, at); }
)")));
  }
  void draw() {
    const output::Gl& gl = bench_.gl();
    gl.UseProgram(program_->id());
    gl.BindVertexArray(array_.id());
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, texture_.id());
    for (std::size_t i = 0; i < 3; ++i) {
      must(bench_.output->draw_to(i));
      const float left = 0.3f * static_cast<float>(i);
      gl.Uniform2f(program_->uniform("from"), left, left + 0.4f);
      gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }
    gl.Finish();
  }

 private:
  Bench& bench_;
  output::GlTexture texture_;
  output::GlVertexArray array_;
  std::optional<output::GlProgram> program_;
};

Json blit(bool quick) {
  Bench bench(4096);
  Blit plain(&bench);
  struct Case {
    std::string name;
    std::vector<display::HeadPainter> painters;
    const display::PanoramaTexture* texture;
    std::vector<double> ratios = {};
  };
  std::vector<Case> cases;
  const auto add = [&](std::string name, const auto& change) {
    std::vector<display::HeadPlan> plans = bench.plans;
    for (display::HeadPlan& plan : plans) change(&plan);
    cases.push_back({std::move(name), bench.painters(plans), &bench.texture_for(plans)});
  };
  add("as shown: warp, masks, sRGB, dithering", [](display::HeadPlan*) {});
  add("without dithering", [](display::HeadPlan* plan) { plan->is_dithered = false; });
  add("without masks (not a picture)", [](display::HeadPlan* plan) { plan->mask = warp::MaskImage(1920, 1080, 1.0f); });
  add("masks everywhere", [](display::HeadPlan* plan) { plan->mask = warp::MaskImage(1920, 1080, 0.99f); });
  add("with a 3x3 matrix", [](display::HeadPlan* plan) { plan->colour.matrix = Eigen::Matrix3d::Identity(); });
  add("with measured responses", [](display::HeadPlan* plan) {
    const warp::ResponseCurve curve = warp::ResponseCurve::power(2.2, 256);
    plan->colour.response = std::array{curve, curve, curve};
  });
  add("with everything", [](display::HeadPlan* plan) {
    const warp::ResponseCurve curve = warp::ResponseCurve::power(2.2, 256);
    plan->colour.response = std::array{curve, curve, curve};
    plan->colour.matrix = Eigen::Matrix3d::Identity();
    plan->colour.black = {0.01, 0.01, 0.01};
    plan->colour.black_lift = warp::BlackLiftImage(1920, 1080, 0.5f);
  });
  // The hall's warps, interpreted as positions in these pictures: each pixel costs the same as on such a wall.
  const PictureShape flat = Perspective{1, 1, -1.1, 1.1, 0.7, -0.7, 0.1};
  const PictureShape dome = Fisheye{1, 1, 2.4, 0.6};
  const auto flat_texture = bench.texture_of(flat);
  const auto dome_texture = bench.texture_of(dome);
  add("on a flat wall, turned", [&](display::HeadPlan* plan) { plan->picture = flat; });
  cases.back().texture = flat_texture.get();
  add("on a dome, turned", [&](display::HeadPlan* plan) { plan->picture = dome; });
  cases.back().texture = dome_texture.get();
  plain.draw();
  for (Case& c : cases) bench.draw(c.painters, *c.texture);
  std::vector<double> plain_s;
  std::vector<double> upload_s;
  for (int turn = 0; turn < (quick ? 5 : 15); ++turn) {
    for (Case& c : cases) {
      const double before = Bench::timed([&] { plain.draw(); });
      const double own = Bench::timed([&] { bench.draw(c.painters, *c.texture); });
      const double after = Bench::timed([&] { plain.draw(); });
      plain_s.push_back(0.5 * (before + after));
      c.ratios.push_back(own / plain_s.back());
    }
    upload_s.push_back(Bench::timed([&] {
      must(bench.texture_for(bench.plans).upload(bench.frame));
      bench.gl().Finish();
    }));
  }
  fmt::print(
      "{}\n3 heads of 1920x1080, a panorama of {}x{}, cpu time by that of bilinear blits of 8 bits ({:.1f} ms)\n",
      bench.gl().renderer(), bench.panorama().width_px, bench.panorama().height_px, 1e3 * middle(plain_s));
  Json figures{{"heads", 3}, {"blit_cpu_ms", 1e3 * middle(plain_s)}, {"pass1_cpu_ms", 1e3 * middle(upload_s)}};
  for (Case& c : cases) {
    fmt::print("  {:<42}{:6.2f}\n", c.name, middle(c.ratios));
    figures["cases"][c.name] = middle(c.ratios);
  }
  fmt::print("  pass 1, once per frame: {:.1f} ms cpu\n", 1e3 * middle(upload_s));
  figures["ratio"] = middle(cases.front().ratios);
  return figures;
}

std::string description(const display::HeadPlan& plan, const Panorama& panorama) {
  const auto* mesh = std::get_if<warp::WarpMesh>(&plan.warp);
  return fmt::format("{} x {}, {}, panorama of {} x {} over {:.2f} rad{}{}{}{}", width_px(plan.warp),
                     height_px(plan.warp), mesh ? fmt::format("mesh {} x {}", mesh->cells_x, mesh->cells_y) : "map",
                     panorama.width_px, panorama.height_px, panorama.azimuth_span_rad,
                     plan.colour.matrix ? ", matrix" : "", plan.colour.black_lift ? ", lift" : "",
                     plan.colour.response ? ", response" : "", plan.is_dithered ? ", dithered" : "");
}

Json exact(bool quick) {
  RandomHeads heads(1);
  double worst_codes = 0.0;
  double worst_exact = 0.0;
  const int count = quick ? 20 : 200;
  for (int n = 0; n < count; ++n) {
    const int width = heads.pixels(16, 200);
    const int height = heads.pixels(16, 160);
    const Panorama panorama{n % 10 == 0 ? 8192 : heads.pixels(16, 400), heads.pixels(16, 120),
                            n % 4 == 0 ? 2.0 * std::numbers::pi : heads.between(0.5, 6.0), 0.5, -0.5};
    const double span = panorama.azimuth_span_rad;
    const display::HeadPlan plan{n % 3 == 2 ? warp::Warp(heads.map(width, height, span))
                                            : warp::Warp(heads.mesh(width, height, span, n % 5 == 0)),
                                 heads.mask(width, height), heads.colour(width, height), 8, n % 2 == 1};
    const PlanarPicture picture = heads.noise(panorama.width_px, panorama.height_px, heads.one_in(2));
    const double shift = heads.between(-1.0, 1.0);
    const RgbImage image = PaintedHead(output::HeadlessOptions::Renderer::kAny).drawn(plan, picture, panorama, shift);
    const double difference = worst_difference(image, plan, ExactPicture(picture, panorama, shift), 0.02, 1.0 / 2048.0);
    if (difference > 1.0) fmt::print("head {}: {:.3f}, {}\n", n, difference, description(plan, panorama));
    worst_codes = std::max(worst_codes, difference);
  }
  // Flat walls and domes, with the heading turned.
  double worst_turned = 0.0;
  for (int n = 0; n < count / 2; ++n) {
    const int width = heads.pixels(16, 200);
    const int height = heads.pixels(16, 160);
    const PictureShape shape = heads.other_shape(heads.pixels(16, 400), heads.pixels(16, 400));
    const bool mapped = n % 2 == 0;
    const double span = mapped && std::holds_alternative<Fisheye>(shape) ? 4.5 : 1.2;
    display::HeadPlan plan{
        mapped ? warp::Warp(heads.map(width, height, span)) : warp::Warp(heads.mesh(width, height, span, n % 3 == 0)),
        heads.mask(width, height), warp::HeadColour{}, 8, n % 4 < 2};
    plan.picture = shape;
    const PlanarPicture picture = heads.noise(width_px(shape), height_px(shape), heads.one_in(2));
    const double turn = n % 5 == 0 ? 0.0 : heads.between(-0.3, 0.3);
    const RgbImage image = PaintedHead(output::HeadlessOptions::Renderer::kAny).drawn(plan, picture, shape, turn);
    worst_turned =
        std::max(worst_turned, worst_difference(image, plan, ExactPicture(picture, shape, turn), 0.02, 1.0 / 2048.0));
  }
  // In a steep ramp, a wrong position gives a wrong code value.
  double worst_px = 0.0;
  for (int n = 0; n < count / 4; ++n) {
    const int width = n % 2 == 0 ? 8192 : 1024;
    const Panorama panorama{width, 64, 3.0, 0.5, -0.5};
    PlanarPicture bars(width, 64, false);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < width; ++x) *bars.luma().at(x, y) = x % 2 == 0 ? 255 : 188;  // Half the light.
    }
    const warp::WarpMesh mesh = heads.mesh(160, 90, 0.05);
    const display::HeadPlan plan{mesh, warp::MaskImage(160, 90, 1.0f), {}, 8, false};
    const RgbImage image = PaintedHead(output::HeadlessOptions::Renderer::kAny).drawn(plan, bars, panorama, 0.1);
    const ExactPicture reference(bars, panorama, 0.1);
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 160; ++x) {
        if (is_on_the_rim(plan.warp, x, y)) continue;
        // The smallest displacement that explains the code value, up to rounding.
        for (double off = 0.0; off <= 0.2; off += 0.001) {
          const double min =
              255.0 * std::min(reference.code_at(plan, x, y, -off)[1], reference.code_at(plan, x, y, off)[1]);
          const double max =
              255.0 * std::max(reference.code_at(plan, x, y, -off)[1], reference.code_at(plan, x, y, off)[1]);
          const double here = 255.0 * reference.code_at(plan, x, y)[1];
          if (image.at(x, y)[1] < std::min(min, here) - 0.57 || image.at(x, y)[1] > std::max(max, here) + 0.57)
            continue;
          worst_px = std::max(worst_px, off);
          break;
        }
      }
    }
  }
  // The hall as shown, every pixel compared, without tolerance for edges.
  Bench bench(4096);
  const ExactPicture reference(*bench.frame.picture, bench.panorama(), 0.05);
  for (const display::HeadPlan& shown : bench.plans) {
    display::HeadPlan plan = shown;
    plan.is_dithered = false;
    const RgbImage image =
        PaintedHead(output::HeadlessOptions::Renderer::kAny).drawn(plan, *bench.frame.picture, bench.panorama(), 0.05);
    worst_exact = std::max(worst_exact, worst_difference(image, plan, reference, 0.0));
  }
  fmt::print("{} random heads: {:.3f} code values within 0.02 px\n", count, worst_codes);
  fmt::print("{} random heads on flat walls and domes, turned: {:.3f} code values within 0.02 px\n", count / 2,
             worst_turned);
  fmt::print("place of a sample: within {:.3f} px\n", worst_px);
  fmt::print("3 heads of 1920x1080, every pixel, nothing forgiven: {:.3f} code values\n", worst_exact);
  return {{"max_code_error", std::max({worst_codes, worst_turned, worst_exact})},
          {"max_px_error", worst_px},
          {"cases", count + count / 2}};
}

Json trade(bool quick) {
  Json figures;
  const int turns = quick ? 3 : 9;
  fmt::print(
      "Warp against error and time: a full HD head, a panorama of 4096 px\n"
      "  model      tolerance px cells       error px    cpu ms     blits\n");
  const auto time_of = [&](Bench* bench, const std::vector<display::HeadPlan>& plans) {
    const std::vector<display::HeadPainter> painters = bench->painters(plans);
    const display::PanoramaTexture& texture = bench->texture_for(plans);
    bench->draw(painters, texture);
    std::vector<double> times;
    for (int turn = 0; turn < turns; ++turn)
      times.push_back(Bench::timed([&] { bench->draw(painters, texture); }) / 3.0);
    return 1e3 * middle(times);
  };
  Bench bench(4096);
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(bench.room());
  const auto with_warps = [&](const auto& warp_of) {
    std::vector<display::HeadPlan> plans = bench.plans;
    for (std::size_t i = 0; i < plans.size(); ++i) plans[i].warp = warp_of(i);
    return plans;
  };
  Blit plain(&bench);
  const auto tell = [&](const char* kind, double tolerance, int across, int down, double error_px,
                        const std::vector<display::HeadPlan>& plans) {
    const double ms = time_of(&bench, plans);
    plain.draw();
    const double blit_ms = 1e3 * Bench::timed([&] { plain.draw(); }) / 3.0;
    fmt::print("  {:<10} {:<10} {:>4} x {:<4} {:>9.4f} {:>9.1f} {:>9.2f}\n", kind, tolerance, across, down, error_px,
               ms, ms / blit_ms);
    figures["warp"].push_back({{"kind", kind},
                               {"tolerance_px", tolerance},
                               {"cells", across * down},
                               {"error_px", error_px},
                               {"cpu_ms", ms},
                               {"blits", ms / blit_ms}});
  };
  for (const double tolerance : {2.0, 0.5, 0.2, 0.05, 0.02, 0.005}) {
    if (warp::make_warp_patches(maps[0], bench.panorama(), tolerance)) {
      const auto plans = with_warps([&](std::size_t i) {
        return warp::Warp(must(warp::make_warp_patches(maps[i], bench.panorama(), tolerance)));
      });
      const auto& warp = std::get<warp::WarpPatches>(plans[0].warp);
      tell("patches", tolerance, warp.across(), warp.down(), warp.worst_error_px, plans);
    }
    const auto plans = with_warps(
        [&](std::size_t i) { return warp::Warp(must(warp::make_warp_mesh(maps[i], bench.panorama(), tolerance))); });
    const auto& mesh = std::get<warp::WarpMesh>(plans[0].warp);
    tell("triangles", tolerance, mesh.cells_x, mesh.cells_y, mesh.worst_error_px, plans);
  }
  tell("map", 0.0, 1920, 1080, 0.0,
       with_warps([&](std::size_t i) { return warp::Warp(warp::make_pixel_map(maps[i], bench.panorama())); }));
  for (const int cell : {32, 16, 8, 6, 4}) {
    const auto plans = with_warps([&](std::size_t i) {
      warp::WarpMesh mesh{1920, 1080, 1920 / cell, 1080 / cell, {}, 0.0};
      for (int row = 0; row <= mesh.cells_y; ++row) {
        for (int column = 0; column <= mesh.cells_x; ++column) {
          const Eigen::Vector2d pixel(1920.0 * column / mesh.cells_x, 1080.0 * row / mesh.cells_y);
          const auto direction = maps[i].direction_of(pixel).value_or(warp::PanoramaDirection{});
          mesh.vertices.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                                   static_cast<float>(direction.azimuth_rad),
                                   static_cast<float>(direction.tan_elevation)});
        }
      }
      return warp::Warp(mesh);
    });
    const double ms = time_of(&bench, plans);
    fmt::print("  cells of {:>2} px: {:.1f} ms\n", cell, ms);
    figures["cells"].push_back({{"cell_px", cell}, {"cpu_ms", ms}});
  }
  fmt::print(
      "Response tables: the nearest of so many steps against the curve, in code values of 8 bits\n  steps    sRGB   "
      "gamma 2.2   gamma 2.6\n");
  for (const std::size_t steps : {64U, 256U, 1024U, 4096U, 16384U}) {
    const auto error_of = [&](const warp::ResponseCurve& table, const warp::ResponseCurve& curve) {
      double worst = 0.0;
      for (int i = 0; i <= 200000; ++i) {
        const double root = i / 200000.0;
        const auto nearest = static_cast<std::size_t>(root * static_cast<double>(steps - 1) + 0.5);
        worst =
            std::max(worst, 255.0 * std::abs(static_cast<double>(table.codes[nearest]) - curve.code_of(root * root)));
      }
      return worst;
    };
    constexpr std::size_t kFine = 1 << 20;
    const std::array errors{error_of(warp::ResponseCurve::srgb(steps), warp::ResponseCurve::srgb(kFine)),
                            error_of(warp::ResponseCurve::power(2.2, steps), warp::ResponseCurve::power(2.2, kFine)),
                            error_of(warp::ResponseCurve::power(2.6, steps), warp::ResponseCurve::power(2.6, kFine))};
    fmt::print("  {:<6}{:>8.3f}{:>10.3f}{:>12.3f}\n", steps, errors[0], errors[1], errors[2]);
    figures["response"].push_back(
        {{"steps", steps}, {"srgb", errors[0]}, {"gamma_2.2", errors[1]}, {"gamma_2.6", errors[2]}});
  }

  fmt::print("Decoding a panorama of 4096 px in tiles of 256: cpu ms, and wall ms by threads\n");
  const RgbImage picture = picture_of(bench.panorama());
  for (const bool half : {true, false}) {
    std::vector<std::pair<PixelRect, std::vector<std::byte>>> tiles;
    for (int y = 0; y < picture.height(); y += 256) {
      for (int x = 0; x < picture.width(); x += 256) {
        const PixelRect position{x, y, std::min(256, picture.width() - x), std::min(256, picture.height() - y)};
        tiles.emplace_back(position, must(JpegEncoder().encode(picture.at(x, y), position.width, position.height,
                                                               picture.row_values(), {85, half})));
      }
    }
    for (const int threads : {1, 2, 4}) {
      std::vector<double> wall;
      std::vector<double> cpu;
      PlanarPicture planes(picture.width(), picture.height(), half);
      for (int turn = 0; turn < turns; ++turn) {
        const TimePoint start = SteadyClock().now();
        cpu.push_back(Bench::timed([&] {
          std::vector<std::jthread> workers;
          for (int t = 0; t < threads; ++t) {
            workers.emplace_back([&, t] {
              JpegDecoder decoder;
              for (std::size_t i = static_cast<std::size_t>(t); i < tiles.size();
                   i += static_cast<std::size_t>(threads)) {
                must(decoder.decode_into(tiles[i].second, &planes, tiles[i].first));
              }
            });
          }
        }));
        wall.push_back(to_seconds(SteadyClock().now() - start));
      }
      fmt::print("  {} chroma, {} threads: {:.1f} cpu ms, {:.1f} ms\n", half ? "half" : "full", threads,
                 1e3 * middle(cpu), 1e3 * middle(wall));
      figures["decode"].push_back({{"half_chroma", half},
                                   {"threads", threads},
                                   {"cpu_ms", 1e3 * middle(cpu)},
                                   {"wall_ms", 1e3 * middle(wall)}});
    }
  }
  return figures;
}

/// Decodes one file in the same way as a tile: megapixels per cpu-second. The script compares it with `tjbench`.
Json decode(const std::string& file, double seconds) {
  const std::vector<std::byte> jpeg = must(read_file(file, std::size_t{64} << 20));
  JpegDecoder decoder;
  const JpegHeader header = must(decoder.header_of(jpeg));
  PlanarPicture planes(header.size.width, header.size.height, header.has_half_chroma.value_or(false));
  const PixelRect position{0, 0, header.size.width, header.size.height};
  must(decoder.decode_into(jpeg, &planes, position));
  const double start = cpu_s();
  int count = 0;
  while (cpu_s() - start < seconds) {
    must(decoder.decode_into(jpeg, &planes, position));
    ++count;
  }
  return {{"megapixels_per_s", 1e-6 * count * static_cast<double>(position.area()) / (cpu_s() - start)}};
}

/// Writes tiles as sent by nodes, for decode() and other decoders.
void write_tiles(const std::string& folder) {
  const RgbImage picture = picture_of({2048, 1024, 2.0, 0.5, -0.5});
  for (const int side : {256, 1024}) {
    for (const bool half : {true, false}) {
      const auto jpeg = must(JpegEncoder().encode(picture.at(512, 0), side, side, picture.row_values(), {85, half}));
      std::ofstream(fmt::format("{}/{}-{}.jpg", folder, half ? "420" : "444", side), std::ios::binary)
          .write(reinterpret_cast<const char*>(jpeg.data()), static_cast<std::streamsize>(jpeg.size()));
    }
  }
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  using namespace cyclorama;
  CLI::App app("Figures of the display");
  bool quick = false;
  std::string json;
  std::string file;
  double seconds = 2.0;
  app.add_flag("--quick", quick);
  app.add_option("--json", json, "Write the figures here");
  app.require_subcommand(1);
  app.fallthrough();
  app.add_subcommand("exact");
  app.add_subcommand("blit");
  app.add_subcommand("trade");
  CLI::App* const decode_command = app.add_subcommand("decode");
  decode_command->add_option("file", file)->required();
  decode_command->add_option("--seconds", seconds);
  CLI::App* const tiles_command = app.add_subcommand("tiles");
  tiles_command->add_option("folder", file)->required();
  CLI11_PARSE(app, argc, argv);
  try {
    nlohmann::json figures;
    if (app.got_subcommand("exact")) figures = exact(quick);
    if (app.got_subcommand("blit")) figures = blit(quick);
    if (app.got_subcommand("trade")) figures = trade(quick);
    if (app.got_subcommand("decode")) figures = decode(file, seconds);
    if (app.got_subcommand("tiles")) write_tiles(file);
    if (!json.empty()) std::ofstream(json) << figures.dump(1) << "\n";
  } catch (const std::exception& error) {
    fmt::print(stderr, "display_bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
