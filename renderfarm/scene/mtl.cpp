// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/geometry/obj_text.h"
#include "common/image/image_file.h"
#include "renderfarm/scene/file_beside.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kMtlLimitBytes = std::size_t{64} << 20;
constexpr std::size_t kNotesLimit = 32;
constexpr int kNamesLimit = 32;  // Maximum number of file names in one mtllib.
constexpr float kPlainRoughness = 0.9f;

Material plain(std::string name) {
  Material material;
  material.name = std::move(name);
  material.metallic = 0.0f;
  material.roughness = kPlainRoughness;
  material.double_sided = true;  // OBJ cannot express this, and open meshes are common.
  return material;
}

std::optional<float> number(std::string_view* rest, float min, float max) {
  const auto value = number_in(next_word(rest), nullptr);
  if (!value || std::isnan(*value)) return std::nullopt;
  return std::clamp(static_cast<float>(std::clamp(*value, -1e30, 1e30)), min, max);
}

/// Reads a colour; a single number stands for all three components.
std::optional<Eigen::Vector3f> colour(std::string_view rest, float max) {
  Eigen::Vector3f rgb;
  for (int i = 0; i < 3; ++i) {
    const auto value = number(&rest, 0.0f, max);
    if (!value && i == 0) return std::nullopt;
    rgb[i] = value.value_or(rgb[0]);
  }
  return rgb;
}

/// Returns the file name after options such as "-s 1 1 1" or "-clamp on", which are skipped.
std::string file_of_map(std::string_view rest) {
  while (rest.starts_with('-')) {
    const std::string_view option = next_word(&rest);
    std::size_t min = 1;
    std::size_t max = 1;
    if (option == "-o" || option == "-s" || option == "-t") max = 3;
    if (option == "-mm") min = max = 2;
    for (std::size_t i = 0; i < max; ++i) {
      std::string_view ahead = rest;
      const std::string_view word = next_word(&ahead);
      bool whole = false;
      if (i >= min && !(number_in(word, &whole) && whole)) break;
      rest = ahead;
    }
    rest = trimmed(rest);
  }
  return std::string(rest);
}

}  // namespace

MtlLibrary::MtlLibrary(std::filesystem::path folder, const ImportLimits& limits)
    : folder_(std::move(folder)), limits_(limits) {
  in_use_.push_back({plain("plain"), {}, {}, {}, {}});
}

void MtlLibrary::note_once(const std::string& note) {
  if (notes_.size() < kNotesLimit && std::find(notes_.begin(), notes_.end(), note) == notes_.end())
    notes_.push_back(note);
}

bool MtlLibrary::read_one(std::string_view name) {
  const std::filesystem::path file = file_beside(folder_, std::string(name));
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  const auto text = read_file(file, kMtlLimitBytes);
  if (text) {
    std::string storage;
    parse(to_utf8(*text, &storage), std::string(name));
  } else {
    note_once(fmt::format("{}: ignored", text.error().message()));
  }
  return true;
}

void MtlLibrary::read(std::string_view names) {
  // The rest of the line is one name that may contain blanks, if such a file exists; otherwise it is several names.
  if (read_one(names)) return;
  for (int i = 0; i < kNamesLimit; ++i) {
    const std::string_view name = next_word(&names);
    if (name.empty()) return;
    if (!read_one(name)) {
      note_once(fmt::format("the material file '{}' is missing: its materials are plain", printable(name)));
    }
  }
}

void MtlLibrary::parse(std::string_view text, const std::string& name) {
  ObjStatements statements(text);
  std::string_view keyword;
  std::string_view rest;
  Entry* entry = nullptr;
  while (statements.next(&keyword, &rest)) {
    if (keyword == "newmtl") {
      entry = &known_[std::string(rest)];
      *entry = {plain(std::string(rest)), {}, {}, {}, {}};
    } else if (entry == nullptr) {
      note_once(fmt::format("line {} of '{}' comes before any newmtl: ignored", statements.line(), printable(name)));
    } else {
      read_statement(keyword, rest, entry);
    }
  }
}

void MtlLibrary::read_statement(std::string_view keyword, std::string_view rest, Entry* entry) {
  Material& material = entry->material;
  if (keyword == "Kd") {
    if (const auto kd = colour(rest, 1.0f)) material.base_colour.head<3>() = *kd;
  } else if (keyword == "Ke") {
    if (const auto ke = colour(rest, 1e6f)) material.emissive = *ke;
  } else if (keyword == "Ns") {
    const auto exponent = number(&rest, 0.0f, 1e6f);
    if (exponent) material.roughness = std::sqrt(std::sqrt(2.0f / (*exponent + 2.0f)));
  } else if (keyword == "Ks") {
    const auto ks = colour(rest, 1.0f);
    if (ks && ks->isZero()) material.roughness = 1.0f;
  } else if (keyword == "Pr") {
    material.roughness = number(&rest, 0.0f, 1.0f).value_or(material.roughness);
  } else if (keyword == "Pm") {
    material.metallic = number(&rest, 0.0f, 1.0f).value_or(material.metallic);
  } else if (keyword == "Pc") {
    material.clearcoat = number(&rest, 0.0f, 1.0f).value_or(material.clearcoat);
  } else if (keyword == "Pcr") {
    material.clearcoat_roughness = number(&rest, 0.0f, 1.0f).value_or(material.clearcoat_roughness);
  } else if (keyword == "d" || keyword == "Tr") {
    const auto value = number(&rest, 0.0f, 1.0f);
    if (value) material.base_colour[3] = keyword == "d" ? *value : 1.0f - *value;
  } else if (keyword == "map_Kd") {
    entry->base_colour_file = file_of_map(rest);
  } else if (keyword == "map_Ke") {
    entry->emissive_file = file_of_map(rest);
  } else if (keyword == "norm") {
    entry->normal_file = file_of_map(rest);
  } else if (keyword == "map_d") {
    entry->cut_out_file = file_of_map(rest);
  } else if (keyword.starts_with("map_") || keyword == "bump" || keyword == "disp" || keyword == "refl") {
    note_once(fmt::format("{} of MTL is not supported: ignored", printable(keyword)));
  }
}

int MtlLibrary::use(std::string_view name) {
  if (const auto found = used_.find(name); found != used_.end()) return found->second;
  const auto known = known_.find(name);
  int index = 0;
  if (known == known_.end()) {
    note_once(fmt::format("the material '{}' is in no material file: it is plain", printable(name)));
  } else {
    index = static_cast<int>(in_use_.size());
    in_use_.push_back(known->second);
  }
  used_.emplace(std::string(name), index);
  return index;
}

int MtlLibrary::texture(const std::string& file, Model* model) {
  if (file.empty()) return -1;
  const auto [place, is_new] = textures_.emplace(file, -1);
  if (!is_new) return place->second;
  const std::size_t bytes_left = limits_.memory_bytes - std::min(limits_.memory_bytes, texture_bytes_);
  auto pixels = read_image(file_beside(folder_, file), std::min(limits_.texture_px, bytes_left / 4));
  if (!pixels) {
    note_once(fmt::format("{}: the material keeps its plain colour", pixels.error().message()));
    return -1;
  }
  texture_bytes_ += pixels->data().size();
  place->second = static_cast<int>(model->textures.size());
  model->textures.push_back({*std::move(pixels)});
  return place->second;
}

void MtlLibrary::finish(Model* model) && {
  for (Entry& entry : in_use_) {
    Material& material = entry.material;
    material.base_colour_texture.texture = texture(entry.base_colour_file, model);
    material.emissive_texture.texture = texture(entry.emissive_file, model);
    material.normal_texture.texture = texture(entry.normal_file, model);
    if (material.emissive_texture.texture >= 0 && material.emissive.isZero()) material.emissive.setOnes();
    const bool has_picture = material.base_colour_texture.texture >= 0;
    if (has_picture && material.base_colour.head<3>().isZero()) material.base_colour.head<3>().setOnes();
    if (material.base_colour[3] == 0.0f) {
      note_once(fmt::format("the material '{}' is wholly transparent, which exporters write by mistake: shown opaque",
                            printable(material.name)));
      material.base_colour[3] = 1.0f;
    }
    if (material.base_colour[3] < 1.0f) material.alpha_mode = AlphaMode::kBlend;
    if (has_picture && entry.cut_out_file == entry.base_colour_file) material.alpha_mode = AlphaMode::kMask;
    if (!entry.cut_out_file.empty() && material.alpha_mode != AlphaMode::kMask) {
      note_once("map_d of MTL with a picture of its own is not supported: ignored");
    }
    model->materials.push_back(std::move(material));
  }
  model->notes.insert(model->notes.end(), notes_.begin(), notes_.end());
}

}  // namespace cyclorama::scene
