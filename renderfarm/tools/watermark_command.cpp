// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/watermark_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/image_file.h"
#include "renderfarm/tools/watermark_curve.h"

namespace cyclorama {
namespace {

constexpr std::size_t kMuseumsLimitBytes = std::size_t{1} << 20;

Result<RgbImage> read_picture(const std::string& path) {
  TRY_ASSIGN(const RgbaImage rgba, read_image(path, kPhotoLimitPx));
  return without_alpha(rgba);
}

struct WatermarkOptions {
  std::string picture;
  std::string museums;
  std::string json;
  bool curve = false;
};

Status detect(const RgbImage& picture, const WatermarkOptions& options) {
  TRY_ASSIGN(const std::string text, read_text_file(options.museums, kMuseumsLimitBytes));
  TRY_ASSIGN(const Grants grants, Grants::parse(text, options.museums));
  nlohmann::json values = nlohmann::json::array();
  fmt::print("{:>7}  {:<24} where\n", "score", "museum");
  const std::vector<WatermarkVerdict> verdicts = find_museum(picture, grants);
  for (const WatermarkVerdict& verdict : verdicts) {
    const bool halved = verdict.cell_px != kWatermarkCellPx;
    fmt::print("{:7.1f}  {:<24} {}, {}{}\n", verdict.find.score, printable(verdict.museum), verdict.find.x_px,
               verdict.find.y_px, halved ? ", half size" : "");
    values.push_back({{"museum", verdict.museum}, {"score", verdict.find.score}});
  }
  const bool certain = !verdicts.empty() && verdicts.front().find.score >= kWatermarkCertain;
  fmt::print("{}\n", certain ? fmt::format("made for {}", printable(verdicts.front().museum))
                             : fmt::format("made for none of them: no score reaches {}", kWatermarkCertain));
  return options.json.empty() ? Status(Done{}) : write_json(options.json, values);
}

Status print_curve(const RgbImage& picture, const WatermarkOptions& options) {
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
  return options.json.empty() ? Status(Done{}) : write_json(options.json, values);
}

Status watermark(const WatermarkOptions& options) {
  TRY_ASSIGN(const RgbImage picture, read_picture(options.picture));
  return options.curve ? print_curve(picture, options) : detect(picture, options);
}

}  // namespace

std::vector<WatermarkVerdict> find_museum(const RgbImage& picture, const Grants& grants) {
  const WatermarkDetector full(picture);
  const WatermarkDetector half(picture, kWatermarkCellPx / 2);
  std::vector<WatermarkVerdict> verdicts;
  for (const auto& [museum, grant] : grants.all()) {
    if (grant.watermark == 0) continue;
    WatermarkVerdict verdict{museum, full.search(grant.watermark)};
    if (const WatermarkFind find = half.search(grant.watermark); find.score > verdict.find.score) {
      verdict = {museum, find, kWatermarkCellPx / 2};
    }
    verdicts.push_back(std::move(verdict));
  }
  std::ranges::stable_sort(verdicts, std::greater{},
                           [](const WatermarkVerdict& verdict) { return verdict.find.score; });
  return verdicts;
}

RenderCommand add_watermark_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("watermark", "Tell for which museum a picture was made");
  const auto options = std::make_shared<WatermarkOptions>();
  parser->add_option("picture", options->picture, "PNG or JPEG; a part of a picture will do")->required();
  CLI::Option* const museums =
      parser->add_option("--museums", options->museums, "The farm's museums.toml, with their keys");
  CLI::Option* const curve = parser->add_flag("--curve", options->curve,
                                              "Instead, what marks of several strengths cost and give on the picture");
  museums->excludes(curve);
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal&) -> Status {
            if (!options->curve && options->museums.empty()) {
              return Error(ErrorCode::kInvalidArgument, "give --museums FILE, or --curve");
            }
            return watermark(*options);
          }};
}

}  // namespace cyclorama
