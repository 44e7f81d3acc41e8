// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <iterator>
#include <string_view>

#include "appliance/interchange/fault.h"
#include "appliance/interchange/mask_png.h"
#include "appliance/interchange/mpcdi.h"
#include "appliance/interchange/mpcdi_words.h"
#include "appliance/interchange/zip_archive.h"
#include "common/base/file.h"
#include "common/image/pfm.h"

namespace cyclorama::interchange {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// Writes the manifest line by line, and collects the members that it names.
class Writer {
 public:
  Result<std::vector<std::byte>> write(const WarpSet& set) {
    const bool old = set.version == MpcdiVersion::k1_0;
    x_resolution_ = old ? "Xresolution" : "xResolution";
    y_resolution_ = old ? "Yresolution" : "yResolution";
    x_size_ = old ? "xsize" : "xSize";
    y_size_ = old ? "ysize" : "ySize";
    // The consortium's reader of version 1.0 accepts only this spelling, and refuses files without the element.
    origin_ = old ? "originof3DData" : "originOf3DData";
    put(R"(<?xml version="1.0" encoding="UTF-8"?>)");
    const std::string levels = old ? fmt::format(R"(level="{}")", set.level)
                                   : fmt::format(R"(geometry="{}" color="{}")", set.level, set.colour_level);
    put(R"(<MPCDI profile="{}" {} date="{}" version="{}">)", mpcdi::word_of(mpcdi::kProfiles, set.profile), levels,
        escaped(set.date), old ? "1.0" : "2.0");
    put("  <display>");
    for (const WarpBuffer& buffer : set.buffers) put_buffer(buffer);
    put("  </display>");
    put("  <files>");
    for (const WarpBuffer& buffer : set.buffers) {
      for (const WarpRegion& region : buffer.regions) TRY(put_files(region));
    }
    put("  </files>");
    put("</MPCDI>");
    std::vector<ZipMember> members{{std::string(mpcdi::kManifest), {}}};
    const auto* const begin = reinterpret_cast<const std::byte*>(xml_.data());
    members.front().bytes.assign(begin, begin + xml_.size());
    std::move(members_.begin(), members_.end(), std::back_inserter(members));
    return write_zip(members);
  }

 private:
  template <typename... Values>
  void put(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(xml_), format, std::forward<Values>(values)...);
    xml_ += '\n';
  }

  void put_buffer(const WarpBuffer& buffer) {
    std::string size;
    if (buffer.width_px > 0) size += fmt::format(R"( {}="{}")", x_resolution_, buffer.width_px);
    if (buffer.height_px > 0) size += fmt::format(R"( {}="{}")", y_resolution_, buffer.height_px);
    put(R"(    <buffer id="{}"{}>)", escaped(buffer.id), size);
    for (const WarpRegion& r : buffer.regions) {
      put(R"(      <region id="{}" {}="{}" {}="{}" x="{}" y="{}" {}="{}" {}="{}">)", escaped(r.id), x_resolution_,
          r.width_px, y_resolution_, r.height_px, r.rect.x, r.rect.y, x_size_, r.rect.width, y_size_, r.rect.height);
      if (r.frustum) put_frustum(*r.frustum);
      if (r.coordinate_frame) put_frame(*r.coordinate_frame);
      put("      </region>");
    }
    put("    </buffer>");
  }

  void put_frustum(const WarpFrustum& f) {
    put("        <frustum>");
    const std::array parts{std::pair{"yaw", f.yaw_deg},        std::pair{"pitch", f.pitch_deg},
                           std::pair{"roll", f.roll_deg},      std::pair{"rightAngle", f.right_deg},
                           std::pair{"leftAngle", f.left_deg}, std::pair{"upAngle", f.up_deg},
                           std::pair{"downAngle", f.down_deg}};
    for (const auto& [name, value] : parts) put("          <{0}>{1}</{0}>", name, value);
    put("        </frustum>");
  }

  void put_frame(const WarpCoordinateFrame& frame) {
    put("        <coordinateFrame>");
    const std::array vectors{std::pair{"pos", frame.position}, std::pair{"yaw", frame.yaw},
                             std::pair{"pitch", frame.pitch}, std::pair{"roll", frame.roll}};
    for (const auto& [name, values] : vectors) {
      for (int i = 0; i < 3; ++i) put("          <{0}{1}>{2}</{0}{1}>", name, "xyz"[i], values[i]);
    }
    put("        </coordinateFrame>");
  }

  Status put_files(const WarpRegion& region) {
    ++number_;
    put(R"(    <fileset region="{}">)", escaped(region.id));
    put("      <geometryWarpFile>");
    put("        <path>{}</path>", region.map ? add("geometry", "pfm", encode_pfm(*region.map)) : "");
    put("        <interpolation>{}</interpolation>", mpcdi::word_of(mpcdi::kInterpolations, region.interpolation));
    put("        <geometricUnit>{}</geometricUnit>", mpcdi::word_of(mpcdi::kUnits, region.unit));
    put("        <{0}>{1}</{0}>", origin_, mpcdi::word_of(mpcdi::kOrigins, region.origin));
    put("      </geometryWarpFile>");
    if (region.alpha) TRY(put_mask("alphaMap", "alpha", *region.alpha));
    if (region.beta) TRY(put_mask("betaMap", "beta", *region.beta));
    if (region.distortion) {
      put("      <distortionMap>");
      put("        <path>{}</path>", add("distortion", "pfm", encode_pfm(*region.distortion)));
      put("      </distortionMap>");
    }
    put("    </fileset>");
    return Done{};
  }

  Status put_mask(std::string_view element, std::string_view name, const MaskMap& mask) {
    TRY_ASSIGN(std::vector<std::byte> png, encode_mask_png(mask));
    put("      <{}>", element);
    put("        <path>{}</path>", add(name, "png", std::move(png)));
    put("        <componentDepth>{}</componentDepth>", mask.channels);
    put("        <bitDepth>{}</bitDepth>", mask.bits);
    put("        <gammaEmbedded>{}</gammaEmbedded>", mask.gamma);
    put("      </{}>", element);
    return Done{};
  }

  /// Adds a member and returns its name. Members are numbered, since a region's id may contain characters that are
  /// invalid in file names.
  std::string add(std::string_view name, std::string_view ending, std::vector<std::byte> bytes) {
    members_.push_back({fmt::format("{}-{}.{}", name, number_, ending), std::move(bytes)});
    return members_.back().name;
  }

  std::string xml_;
  std::vector<ZipMember> members_;
  int number_ = 0;
  std::string_view x_resolution_, y_resolution_, x_size_, y_size_, origin_;
};

}  // namespace

Result<std::vector<std::byte>> encode_mpcdi(const WarpSet& set) {
  TRY(check(set));
  return Writer().write(set);
}

Status write_mpcdi(const std::filesystem::path& path, const WarpSet& set) {
  auto bytes = encode_mpcdi(set);
  if (!bytes) return std::move(bytes).error().while_doing(fmt::format("writing MPCDI '{}'", path.string()));
  return write_file_atomically(path, *bytes);
}

}  // namespace cyclorama::interchange
