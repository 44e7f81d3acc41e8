// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/watermark_curve_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/image/image_file.h"
#include "tests/bench/render/watermark_curve.h"

namespace cyclorama {
namespace {

struct WatermarkCurveOptions {
  std::string picture;
  std::string json;
};

Status print_curve(const WatermarkCurveOptions& options) {
  TRY_ASSIGN(const RgbaImage rgba, read_image(options.picture, kPhotoLimitPx));
  const RgbImage picture = without_alpha(rgba);
  TRY_ASSIGN(const std::vector<WatermarkPoint> points, measure_watermark(picture));
  nlohmann::json values = nlohmann::json::array();
  fmt::print("codes  cells  grey: PSNR dB   FLIP  here: FLIP  bytes   ms/MP   score at Q95   Q85   Q75   Q50  half\n");
  for (const WatermarkPoint& point : points) {
    fmt::print(
        "{:>5}   1/{:<3}  {:>13.1f}  {:.4f}      {:.4f}  {:>+4.1f} %  {:5.2f}  {:>13.1f} {:>5.1f} {:>5.1f} {:>5.1f} "
        "{:>5.1f}\n",
        point.strength.amplitude, 1 << point.strength.sparseness, point.grey_psnr_db, point.grey_flip, point.flip,
        100.0 * point.more_bytes, point.ms_per_megapixel, point.scores[0], point.scores[1], point.scores[2],
        point.scores[3], point.half_score);
    values.push_back({{"amplitude", point.strength.amplitude},
                      {"cells_per_mark", 1 << point.strength.sparseness},
                      {"grey_psnr_db", point.grey_psnr_db},
                      {"grey_flip", point.grey_flip},
                      {"flip", point.flip},
                      {"more_bytes", point.more_bytes},
                      {"ms_per_megapixel", point.ms_per_megapixel},
                      {"scores", point.scores},
                      {"half_score", point.half_score}});
  }
  return options.json.empty() ? Status(Done{}) : tools::write_json(options.json, values);
}

}  // namespace

tools::RenderCommand add_watermark_curve_command(CLI::App* program) {
  CLI::App* const parser =
      program->add_subcommand("watermark", "What marks of several strengths cost and give on a picture");
  const auto options = std::make_shared<WatermarkCurveOptions>();
  parser->add_option("picture", options->picture, "PNG or JPEG")->required();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal&) { return print_curve(*options); }};
}

}  // namespace cyclorama
