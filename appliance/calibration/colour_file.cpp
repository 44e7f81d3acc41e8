// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/colour_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "appliance/interchange/mask_png.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/json/strict_json.h"

namespace cyclorama::calibration {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using OneChannel = Image<float, 1>;

constexpr int kVersion = 2;
constexpr const char* kFile = "colours.json";
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxPx = std::size_t{64} << 20;
constexpr std::size_t kMaxCodes = 65536;
constexpr std::array<const char*, 3> kChannels{"red", "green", "blue"};

// Pictures are numbered from 1 like the maps, since a projector's name may be invalid as a file name.
std::string mask_file(std::size_t index) { return fmt::format("{}.mask.png", index + 1); }
std::string black_lift_file(std::size_t index) { return fmt::format("{}.black_lift.png", index + 1); }

Status write_picture(const fs::path& file, const OneChannel& picture) {
  interchange::MaskMap map(picture.width(), picture.height(), 1, 16);
  for (std::size_t i = 0; i < map.samples.size(); ++i) {
    const float value = picture.data()[i];
    map.samples[i] = static_cast<std::uint16_t>(std::lround(65535.0f * (value > 0.0f ? std::min(value, 1.0f) : 0.0f)));
  }
  TRY_ASSIGN(const std::vector<std::byte> png, interchange::encode_mask_png(map));
  return write_file_atomically(file, std::span<const std::byte>(png));
}

Result<OneChannel> read_picture(const fs::path& file) {
  TRY_ASSIGN(const std::vector<std::byte> png, read_file(file, kMaxPx));
  auto map = interchange::decode_mask_png(png, kMaxPx);
  if (!map) return std::move(map).error().while_doing(fmt::format("reading '{}'", file.string()));
  OneChannel picture(map->width_px, map->height_px);
  for (int y = 0; y < map->height_px; ++y) {
    for (int x = 0; x < map->width_px; ++x) *picture.at(x, y) = static_cast<float>(map->light_at(x, y));
  }
  return picture;
}

warp::HeadColour colour_of(StrictJson* json) {
  warp::HeadColour colour;
  if (json->has("matrix")) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Index r = 0;
    for (const StrictJson& row : json->list("matrix", 3, 3)) {
      Eigen::Index c = 0;
      for (const StrictJson& value : row.elements(3, 3)) matrix(r, c++) = value.as_number(-100.0, 100.0);
      ++r;
    }
    colour.matrix = matrix;
  }
  if (json->has("black_lift")) {
    colour.black_lift.emplace();
    const auto black = json->list("black_linear", 3, 3);
    for (std::size_t c = 0; c < black.size(); ++c)
      colour.black[static_cast<Eigen::Index>(c)] = black[c].as_number(0.0, 1.0);
  }
  if (json->has("response")) {
    StrictJson response = json->at("response");
    colour.response.emplace();
    for (std::size_t c = 0; c < kChannels.size(); ++c) {
      warp::ResponseCurve& curve = (*colour.response)[c];
      for (const StrictJson& code : response.list(kChannels[c], 2, kMaxCodes))
        curve.codes.push_back(static_cast<float>(code.as_number(0.0, 1.0)));
      if (!curve.is_valid()) response.at(kChannels[c]).refuse("is no rising row of codes; calibrate again");
    }
    response.refuse_other_keys();
  }
  return colour;
}

}  // namespace

std::string colours_json(std::span<const CalibratedColour> colours) {
  Json projectors = Json::array();
  for (const CalibratedColour& one : colours) {
    Json json{{"name", one.name}, {"mask", mask_file(projectors.size())}};
    if (one.colour.black_lift) {
      json["black_lift"] = black_lift_file(projectors.size());
      json["black_linear"] = {one.colour.black.x(), one.colour.black.y(), one.colour.black.z()};
    }
    if (one.colour.matrix) {
      Json rows = Json::array();
      for (Eigen::Index r = 0; r < 3; ++r)
        rows.push_back({(*one.colour.matrix)(r, 0), (*one.colour.matrix)(r, 1), (*one.colour.matrix)(r, 2)});
      json["matrix"] = std::move(rows);
    }
    if (one.colour.response) {
      for (std::size_t c = 0; c < kChannels.size(); ++c)
        json["response"][kChannels[c]] = (*one.colour.response)[c].codes;
    }
    projectors.push_back(std::move(json));
  }
  const Json json{{"format", "cyclorama-colours"}, {"version", kVersion}, {"projectors", std::move(projectors)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<std::vector<CalibratedColour>> parse_colours(std::string_view text, const std::string& name) {
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, "go back to a calibration that was kept"));
  StrictJson::Mistakes mistakes("calibrate again");
  StrictJson json(document, &mistakes);
  if (json.text("format", 60) != "cyclorama-colours")
    json.at("format").refuse("is not 'cyclorama-colours'; give another file");
  json.require_version(kVersion);
  std::vector<CalibratedColour> colours;
  std::set<std::string> names;
  for (StrictJson p : json.list("projectors", 0, 64)) {
    CalibratedColour one;
    one.name = p.text("name", 60);
    if (!names.insert(one.name).second) p.at("name").refuse("is another projector's name; give each its own");
    // The file cannot choose the paths of its pictures.
    const std::size_t index = colours.size();
    if (p.text("mask", 80) != mask_file(index)) p.at("mask").refuse("is not 'N.mask.png'; calibrate again");
    if (p.has("black_lift") && p.text("black_lift", 80) != black_lift_file(index))
      p.at("black_lift").refuse("is not 'N.black_lift.png'; calibrate again");
    one.colour = colour_of(&p);
    p.refuse_other_keys();
    colours.push_back(std::move(one));
  }
  json.refuse_other_keys();
  TRY(mistakes.status(name));
  return colours;
}

Status write_colours(const fs::path& own_folder, std::span<const CalibratedColour> colours) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (!names.insert(colours[i].name).second) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("two projectors are called '{}'; give each its own name", printable(colours[i].name)));
    }
    TRY(write_picture(own_folder / mask_file(i), colours[i].mask));
    if (colours[i].colour.black_lift)
      TRY(write_picture(own_folder / black_lift_file(i), *colours[i].colour.black_lift));
  }
  return write_file_atomically(own_folder / kFile, colours_json(colours));
}

Result<std::vector<CalibratedColour>> read_colours(const fs::path& own_folder) {
  auto text = read_text_file(own_folder / kFile, kMaxBytes);
  if (!text && text.error().code() == ErrorCode::kNotFound) return std::vector<CalibratedColour>{};
  if (!text) return std::move(text).error();
  TRY_ASSIGN(std::vector<CalibratedColour> colours, parse_colours(*text, (own_folder / kFile).string()));
  for (std::size_t i = 0; i < colours.size(); ++i) {
    TRY_ASSIGN(colours[i].mask, read_picture(own_folder / mask_file(i)));
    if (!colours[i].colour.black_lift) continue;
    TRY_ASSIGN(colours[i].colour.black_lift, read_picture(own_folder / black_lift_file(i)));
  }
  return colours;
}

}  // namespace cyclorama::calibration
