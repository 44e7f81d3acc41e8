// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/watermark_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/image_file.h"

namespace cyclorama::tools {
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
};

Status detect(const WatermarkOptions& options) {
  TRY_ASSIGN(const RgbImage picture, read_picture(options.picture));
  TRY_ASSIGN(const std::string text, read_text_file(options.museums, kMuseumsLimitBytes));
  TRY_ASSIGN(const trust::Grants grants, trust::Grants::parse(text, options.museums));
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

}  // namespace

std::vector<WatermarkVerdict> find_museum(const RgbImage& picture, const trust::Grants& grants) {
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
  CLI::App* const parser = program->add_subcommand("watermark", "Find the museum for which a picture was made");
  const auto options = std::make_shared<WatermarkOptions>();
  parser->add_option("picture", options->picture, "PNG or JPEG; a part of a picture will do")->required();
  parser->add_option("--museums", options->museums, "The farm's museums.toml, which contains the keys")->required();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal&) { return detect(*options); }};
}

}  // namespace cyclorama::tools
