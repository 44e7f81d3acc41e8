// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/compare_command.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "common/image/image_file.h"
#include "common/image/pfm.h"
#include "renderfarm/quality/comparable.h"
#include "renderfarm/quality/light_error.h"
#include "renderfarm/render/tone.h"

namespace cyclorama::tools {
namespace {

constexpr std::size_t kLimitBytes = std::size_t{1} << 30;

struct Picture {
  std::optional<RadianceImage> light;
  RgbImage codes;
};

Result<Picture> decode(std::span<const std::byte> bytes) {
  const bool is_pfm = bytes.size() > 2 && bytes[0] == std::byte{'P'} && (bytes[1] | std::byte{0x20}) == std::byte{'f'};
  Picture picture;
  if (!is_pfm) {
    TRY_ASSIGN(const RgbaImage rgba, decode_image(bytes, kPhotoLimitPx));
    picture.codes = without_alpha(rgba);
    return picture;
  }
  TRY_ASSIGN(picture.light, decode_pfm(bytes, kPhotoLimitPx));
  TRY(quality::check_finite(*picture.light));
  picture.codes = render::developed(*picture.light, scene::ToneCurve::kShoulder);
  return picture;
}

Result<Picture> read(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(path, kLimitBytes));
  Result<Picture> picture = decode(bytes);
  if (!picture) return std::move(picture).error().while_doing(fmt::format("'{}'", path.string()));
  return picture;
}

struct CompareOptions {
  std::string picture;
  std::string reference;
  std::string json;
};

Status compare(const CompareOptions& options) {
  TRY_ASSIGN(const Comparison comparison, compare_files(options.picture, options.reference));
  nlohmann::json values = {{"ssim", comparison.shown.ssim}, {"flip", comparison.shown.flip}};
  if (comparison.light) {
    values["mse"] = comparison.light->mse;
    values["relmse"] = comparison.light->relmse;
    fmt::print("MSE     {:.6g}\nrelMSE  {:.6g}\n", comparison.light->mse, comparison.light->relmse);
  }
  // JSON has no infinity, which is the PSNR of equal pictures.
  if (std::isfinite(comparison.shown.psnr_db)) values["psnr_db"] = comparison.shown.psnr_db;
  fmt::print("PSNR    {:.2f} dB\nSSIM    {:.5f}\nFLIP    {:.5f}\n", comparison.shown.psnr_db, comparison.shown.ssim,
             comparison.shown.flip);
  return options.json.empty() ? Status(Done{}) : write_json(options.json, values);
}

}  // namespace

Result<Comparison> compare_files(const std::filesystem::path& picture_path,
                                 const std::filesystem::path& reference_path) {
  TRY_ASSIGN(const Picture picture, read(picture_path));
  TRY_ASSIGN(const Picture reference, read(reference_path));
  Comparison comparison;
  TRY_ASSIGN(comparison.shown, quality::shown_error(picture.codes, reference.codes));
  if (picture.light && reference.light) {
    LightErrors light;
    TRY_ASSIGN(light.mse, quality::mean_squared_error(*picture.light, *reference.light));
    TRY_ASSIGN(light.relmse, quality::relative_squared_error(*picture.light, *reference.light));
    comparison.light = light;
  }
  return comparison;
}

RenderCommand add_compare_command(CLI::App* program) {
  CLI::App* const parser = program->add_subcommand("compare", "Print the errors of a picture against a reference");
  const auto options = std::make_shared<CompareOptions>();
  parser->add_option("picture", options->picture, "PFM (exposed light), PNG or JPEG")->required();
  parser->add_option("reference", options->reference, "A picture of the same size")->required();
  parser->add_option("--json", options->json, "Also write the figures as JSON");
  return {parser, [options](const StopSignal&) { return compare(*options); }};
}

}  // namespace cyclorama::tools
