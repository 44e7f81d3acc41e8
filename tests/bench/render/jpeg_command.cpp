// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/jpeg_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/image/image_file.h"
#include "tests/bench/render/jpeg_curve.h"

namespace cyclorama {
namespace {

struct JpegCommandOptions {
  std::string picture;
  std::string json;
};

Status print_curve(const JpegCommandOptions& options) {
  TRY_ASSIGN(const RgbaImage rgba, read_image(options.picture, kPhotoLimitPx));
  const RgbImage picture = without_alpha(rgba);
  TRY_ASSIGN(const std::vector<JpegPoint> points, measure_jpeg(picture));
  const double pixels = static_cast<double>(picture.width()) * picture.height();
  nlohmann::json values = nlohmann::json::array();
  fmt::print("{:>6} {:>8} {:>7} {:>9} {:>10} {:>13} {:>13} {:>8} {:>7} {:>7}\n", "tile", "quality", "chroma", "kB",
             "bits/pixel", "encode ms/MP", "decode ms/MP", "PSNR dB", "SSIM", "FLIP");
  for (const JpegPoint& point : points) {
    const char* const chroma = point.options.subsample_chroma ? "4:2:0" : "4:4:4";
    fmt::print("{:>6} {:>8} {:>7} {:>9.1f} {:>10.2f} {:>13.2f} {:>13.2f} {:>8.1f} {:>7.4f} {:>7.4f}\n", point.tile_px,
               point.options.quality, chroma, 1e-3 * static_cast<double>(point.bytes),
               8.0 * static_cast<double>(point.bytes) / pixels, point.encode_ms_per_megapixel,
               point.decode_ms_per_megapixel, point.error.psnr_db, point.error.ssim, point.error.flip);
    values.push_back({{"tile_px", point.tile_px},
                      {"quality", point.options.quality},
                      {"chroma", chroma},
                      {"bytes", point.bytes},
                      {"encode_ms_per_megapixel", point.encode_ms_per_megapixel},
                      {"decode_ms_per_megapixel", point.decode_ms_per_megapixel},
                      {"psnr_db", point.error.psnr_db},
                      {"ssim", point.error.ssim},
                      {"flip", point.error.flip}});
  }
  return options.json.empty() ? Status(Done{}) : tools::write_json(options.json, values);
}

}  // namespace

tools::RenderCommand add_jpeg_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("jpeg", "What a picture costs as JPEG, by quality, chroma and size of tiles");
  const auto options = std::make_shared<JpegCommandOptions>();
  parser->add_option("picture", options->picture, "PNG or JPEG")->required();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal&) { return print_curve(*options); }};
}

}  // namespace cyclorama
