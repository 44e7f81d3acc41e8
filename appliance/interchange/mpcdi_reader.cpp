// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "appliance/interchange/fault.h"
#include "appliance/interchange/mask_png.h"
#include "appliance/interchange/mpcdi.h"
#include "appliance/interchange/mpcdi_words.h"
#include "appliance/interchange/warp_pfm.h"
#include "appliance/interchange/xml_reader.h"
#include "appliance/interchange/zip_archive.h"
#include "common/base/file.h"
#include "common/base/text.h"

namespace cyclorama::interchange {
namespace {

constexpr std::size_t kManifestLimitBytes = std::size_t{4} << 20;
constexpr int kMaxPx = 1 << 20;  ///< Maximum size of a buffer each way; regions have stricter limits.
constexpr int kMaxLevel = 4;

/// Reads a manifest and, if it is in an archive, the members that it names.
class Reader {
 public:
  Reader(ZipReader* archive, const WarpLimits& limits) : archive_(archive), limits_(limits) {}

  Result<MpcdiFile> read(std::string_view manifest) {
    TRY_ASSIGN(const std::unique_ptr<XmlDocument> document,
               XmlDocument::parse(manifest, std::string(mpcdi::kManifest), kManifestLimitBytes));
    TRY_ASSIGN(const XmlElement root, document->root("MPCDI"));
    TRY(read_head(root));
    TRY_ASSIGN(const XmlElement display, root.child("display"));
    for (const XmlElement& element : display.all_children()) TRY(read_buffer(element));
    TRY(read_files(root));
    if (Status status = check(file_.set); !status) {
      return std::move(status).error().while_doing(mpcdi::kManifest);
    }
    return std::move(file_);
  }

 private:
  Status read_head(const XmlElement& root) {
    TRY_ASSIGN(const std::string profile, root.attribute("profile"));
    const auto known = mpcdi::value_of(mpcdi::kProfiles, profile);
    if (!known) {
      return fault(root.location(), fmt::format("its profile is '{}'", printable(profile)), "give 2d, 3d, a3 or sl");
    }
    file_.set.profile = *known;
    TRY_ASSIGN(const std::string version, root.attribute("version"));
    if (version != "1.0" && version != "2.0") {
      return fault(root.location(), fmt::format("its version is '{}'", printable(version)),
                   "export it as MPCDI 1.0 or 2.0");
    }
    file_.set.version = version == "1.0" ? MpcdiVersion::k1_0 : MpcdiVersion::k2_0;
    TRY_ASSIGN(const auto date, root.optional_attribute("date"));
    file_.set.date = date.value_or("");
    const bool old = file_.set.version == MpcdiVersion::k1_0;
    TRY_ASSIGN(const auto level, root.optional_count_attribute(old ? "level" : "geometry", kMaxLevel));
    file_.set.level = level.value_or(1);
    TRY_ASSIGN(const auto colour, root.optional_count_attribute("color", kMaxLevel));
    if (!old) file_.set.colour_level = colour.value_or(1);
    return Done{};
  }

  Status read_buffer(const XmlElement& element) {
    if (!element.is("buffer")) {
      ignore(element, "an unknown part of the display");
      return Done{};
    }
    WarpBuffer buffer;
    TRY_ASSIGN(buffer.id, element.attribute("id"));
    TRY_ASSIGN(const auto width, element.optional_count_attribute("xResolution", kMaxPx));
    TRY_ASSIGN(const auto height, element.optional_count_attribute("yResolution", kMaxPx));
    buffer.width_px = width.value_or(0);
    buffer.height_px = height.value_or(0);
    for (const XmlElement& child : element.all_children()) {
      if (child.is("region")) {
        if (++regions_ > limits_.regions) {
          return fault(child.location(), fmt::format("more than {} regions", limits_.regions), "split the file");
        }
        TRY_ASSIGN(WarpRegion region, read_region(child));
        buffer.regions.push_back(std::move(region));
      } else {
        ignore(child, "an unknown part of a buffer");
      }
    }
    file_.set.buffers.push_back(std::move(buffer));
    return Done{};
  }

  Result<WarpRegion> read_region(const XmlElement& element) {
    WarpRegion region;
    TRY_ASSIGN(region.id, element.attribute("id"));
    for (const auto& [name, side] :
         {std::pair{"xResolution", &region.width_px}, std::pair{"yResolution", &region.height_px}}) {
      TRY_ASSIGN(const auto count, element.optional_count_attribute(name, kMaxPx));
      if (!count) {
        return fault(element.location(), fmt::format("it has no attribute {}", name), "give the projector's pixels");
      }
      *side = *count;
    }
    TRY_ASSIGN(region.rect.x, element.number_attribute("x"));
    TRY_ASSIGN(region.rect.y, element.number_attribute("y"));
    TRY_ASSIGN(region.rect.width, element.number_attribute("xSize"));
    TRY_ASSIGN(region.rect.height, element.number_attribute("ySize"));
    TRY_ASSIGN(const auto frustum, element.optional_child("frustum"));
    if (frustum) {
      TRY_ASSIGN(region.frustum, read_frustum(*frustum));
    }
    TRY_ASSIGN(const auto frame, element.optional_child("coordinateFrame"));
    if (frame) {
      TRY_ASSIGN(region.coordinate_frame, read_frame(*frame));
    }
    TRY_ASSIGN(const auto inner, element.optional_child("fileset"));
    if (inner) TRY(read_fileset(*inner, &region));
    for (const XmlElement& child : element.all_children()) {
      if (!child.is("frustum") && !child.is("coordinateFrame") && !child.is("fileset")) {
        ignore(child, "an unknown part of a region");
      }
    }
    return region;
  }

  static Result<std::optional<WarpFrustum>> read_frustum(const XmlElement& element) {
    WarpFrustum frustum;
    const std::array parts{std::pair{"yaw", &frustum.yaw_deg},        std::pair{"pitch", &frustum.pitch_deg},
                           std::pair{"roll", &frustum.roll_deg},      std::pair{"rightAngle", &frustum.right_deg},
                           std::pair{"leftAngle", &frustum.left_deg}, std::pair{"upAngle", &frustum.up_deg},
                           std::pair{"downAngle", &frustum.down_deg}};
    for (const auto& [name, value] : parts) {
      TRY_ASSIGN(*value, element.number_in(name));
    }
    return std::optional(frustum);
  }

  static Result<std::optional<WarpCoordinateFrame>> read_frame(const XmlElement& element) {
    WarpCoordinateFrame frame;
    const std::array vectors{std::pair{"pos", frame.position}, std::pair{"yaw", frame.yaw},
                             std::pair{"pitch", frame.pitch}, std::pair{"roll", frame.roll}};
    for (const auto& [name, values] : vectors) {
      for (int i = 0; i < 3; ++i) {
        TRY_ASSIGN(values[i], element.number_in(fmt::format("{}{}", name, "xyz"[i])));
      }
    }
    return std::optional(frame);
  }

  /// Reads the file sets, which are in <files>, as the standard requires, or beside it, as some tools write them.
  Status read_files(const XmlElement& root) {
    std::vector<XmlElement> sets = root.children("fileset");
    TRY_ASSIGN(const auto files, root.optional_child("files"));
    if (files) {
      for (const XmlElement& child : files->all_children()) {
        if (child.is("fileset")) {
          sets.push_back(child);
        } else {
          ignore(child, "an unknown part of the files");
        }
      }
    }
    for (const XmlElement& element : sets) {
      TRY_ASSIGN(const std::string id, element.attribute("region"));
      WarpRegion* region = nullptr;
      for (WarpBuffer& buffer : file_.set.buffers) {
        for (WarpRegion& candidate : buffer.regions) {
          if (candidate.id == id) region = &candidate;
        }
      }
      if (region == nullptr) {
        return fault(element.location(), fmt::format("there is no region '{}'", printable(id)),
                     "correct the region's id");
      }
      TRY(read_fileset(element, region));
    }
    for (const XmlElement& child : root.all_children()) {
      if (!child.is("display") && !child.is("files") && !child.is("fileset")) ignore(child, "nothing here reads it");
    }
    return Done{};
  }

  Status read_fileset(const XmlElement& element, WarpRegion* region) {
    if (!filled_.insert(region->id).second) {
      return fault(element.location(), fmt::format("region '{}' has its files twice", printable(region->id)),
                   "remove one fileset");
    }
    TRY_ASSIGN(const auto warp, element.optional_child("geometryWarpFile"));
    if (warp) TRY(read_warp(*warp, region));
    TRY_ASSIGN(const auto alpha, element.optional_child("alphaMap"));
    if (alpha) {
      TRY_ASSIGN(region->alpha, read_mask(*alpha));
    }
    TRY_ASSIGN(const auto beta, element.optional_child("betaMap"));
    if (beta) {
      TRY_ASSIGN(region->beta, read_mask(*beta));
    }
    TRY_ASSIGN(const auto distortion, element.optional_child("distortionMap"));
    if (distortion) {
      TRY_ASSIGN(region->distortion, read_pfm(*distortion));
    }
    for (const XmlElement& child : element.all_children()) {
      if (!child.is("geometryWarpFile") && !child.is("alphaMap") && !child.is("betaMap") &&
          !child.is("distortionMap")) {
        ignore(child, "colour is not corrected from it");
      }
    }
    return Done{};
  }

  Status read_warp(const XmlElement& element, WarpRegion* region) {
    TRY_ASSIGN(region->unit, word(element, "geometricUnit", mpcdi::kUnits));
    TRY_ASSIGN(region->origin, word(element, "originOf3DData", mpcdi::kOrigins));
    TRY_ASSIGN(region->interpolation, word(element, "interpolation", mpcdi::kInterpolations));
    TRY_ASSIGN(region->map, read_pfm(element));
    return Done{};
  }

  /// Reads a word of an enumeration. Absent and unrecognised words count as "unknown", since the reference library
  /// writes wrong words where they have no meaning.
  template <typename T, std::size_t N>
  Result<T> word(const XmlElement& element, std::string_view name, const mpcdi::Words<T, N>& words) {
    TRY_ASSIGN(const auto child, element.optional_child(name));
    if (!child) return T::kUnknown;
    const std::string text = child->text();
    const auto value = mpcdi::value_of(words, text);
    if (!value && !text.empty()) ignore(*child, fmt::format("the unknown word '{}'", printable(text)));
    return value.value_or(T::kUnknown);
  }

  /// Returns the member that an element's <path> names; empty if the path is empty, as in exports of poses alone.
  Result<std::optional<std::vector<std::byte>>> member(const XmlElement& element) {
    TRY_ASSIGN(const XmlElement path, element.child("path"));
    const std::string name = path.text();
    if (name.empty()) return std::optional<std::vector<std::byte>>();
    if (archive_ == nullptr) {
      return fault(path.location(), fmt::format("'{}' lies outside of this file", printable(name)),
                   "give the .mpcdi archive");
    }
    auto bytes = archive_->read(name);
    if (!bytes) return std::move(bytes).error().while_doing(path.location());
    return std::optional(*std::move(bytes));
  }

  Result<std::optional<WarpMap>> read_pfm(const XmlElement& element) {
    TRY_ASSIGN(const auto bytes, member(element));
    if (!bytes) return std::optional<WarpMap>();
    auto map = decode_warp_pfm(*bytes, limits_);
    if (!map) return std::move(map).error().while_doing(member_name(element));
    return std::optional(*std::move(map));
  }

  Result<std::optional<MaskMap>> read_mask(const XmlElement& element) {
    TRY_ASSIGN(const auto bytes, member(element));
    if (!bytes) return std::optional<MaskMap>();
    auto mask = decode_mask_png(*bytes, limits_.map_px);
    if (!mask) return std::move(mask).error().while_doing(member_name(element));
    TRY(compare_depth(element, "bitDepth", mask->bits));
    TRY(compare_depth(element, "componentDepth", mask->channels));
    TRY_ASSIGN(const auto gamma, element.optional_child("gammaEmbedded"));
    if (gamma) {
      TRY_ASSIGN(mask->gamma, element.number_in("gammaEmbedded"));
    }
    return std::optional(*std::move(mask));
  }

  /// Ignores a stated depth that differs from the PNG's: exporters write outdated values, and the PNG is authoritative.
  Status compare_depth(const XmlElement& element, std::string_view name, int truth) {
    TRY_ASSIGN(const auto child, element.optional_child(name));
    if (!child) return Done{};
    TRY_ASSIGN(const double said, element.number_in(name));
    if (said != truth) ignore(*child, fmt::format("it says {} and its picture has {}", said, truth));
    return Done{};
  }

  static std::string member_name(const XmlElement& element) {
    const auto path = element.child("path");
    return fmt::format("member '{}'", path ? printable(path->text()) : "");
  }

  void ignore(const XmlElement& element, std::string_view what) {
    file_.ignored.push_back(fmt::format("{}: {}", element.location(), what));
  }

  ZipReader* archive_;
  WarpLimits limits_;
  MpcdiFile file_;
  std::size_t regions_ = 0;
  std::set<std::string> filled_;
};

bool is_zip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{'P'} && bytes[1] == std::byte{'K'};
}

}  // namespace

Result<MpcdiFile> decode_mpcdi(std::span<const std::byte> bytes, const WarpLimits& limits) {
  if (bytes.size() > limits.file_bytes) {
    return fault("file", fmt::format("{} bytes, and at most {} are accepted", bytes.size(), limits.file_bytes),
                 "export fewer regions into it");
  }
  if (!is_zip(bytes)) {
    Reader reader(nullptr, limits);
    return reader.read({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  TRY_ASSIGN(ZipReader archive, ZipReader::open(bytes, limits.total_bytes));
  // Early exporters named the manifest mpacs.xml; the reference library accepts it too.
  std::string name(mpcdi::kManifest);
  const std::vector<std::string>& names = archive.names();
  if (std::find(names.begin(), names.end(), name) == names.end() &&
      std::find(names.begin(), names.end(), "mpacs.xml") != names.end()) {
    name = "mpacs.xml";
  }
  TRY_ASSIGN(const std::vector<std::byte> manifest, archive.read(name));
  Reader reader(&archive, limits);
  return reader.read({reinterpret_cast<const char*>(manifest.data()), manifest.size()});
}

Result<MpcdiFile> read_mpcdi(const std::filesystem::path& path, const WarpLimits& limits) {
  auto bytes = read_file(path, limits.file_bytes);
  if (!bytes) return std::move(bytes).error();
  auto file = decode_mpcdi(*bytes, limits);
  if (!file) return std::move(file).error().while_doing(fmt::format("reading MPCDI '{}'", path.string()));
  return file;
}

}  // namespace cyclorama::interchange
