// SPDX-License-Identifier: Apache-2.0
/// Corruptions of files of each format. Every result must be refused, so changes that may be harmless are not included.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/interchange/zip_archive.h"
#include "common/base/check.h"
#include "tests/data_sets/generated_warps.h"

namespace cyclorama {

struct Corrupted {
  std::string how;
  std::string bytes;
};

inline std::string replaced(std::string text, std::string_view old, std::string_view now) {
  const std::size_t at = text.find(old);
  CHECK(at != std::string::npos);
  return text.replace(at, old.size(), now);
}

/// Returns the first line that begins at or after `at`, as [begin, end) including its line end.
inline std::pair<std::size_t, std::size_t> line_from(const std::string& text, std::size_t at) {
  const std::size_t begin = at == 0 ? 0 : text.find('\n', at - 1) + 1;
  return {begin, text.find('\n', begin) + 1};
}

inline std::string with_line(std::string text, std::size_t at, std::string_view line) {
  const auto [begin, end] = line_from(text, at);
  return text.replace(begin, end - begin, line);
}

inline std::vector<Corrupted> corrupted_pfm(const std::string& pfm, GeneratedWarps* made) {
  const std::size_t pixels = pfm.find("-1.0\n") + 5;
  std::string infinite = pfm;
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(infinite.data() + pixels, &infinity, sizeof(infinity));
  return {{"cut", pfm.substr(0, static_cast<std::size_t>(made->count(0, static_cast<int>(pfm.size()) - 1)))},
          {"longer", pfm + "x"},
          {"grey", replaced(pfm, "PF", "Pf")},
          {"another format", replaced(pfm, "PF", "P6")},
          {"no size", replaced(pfm, "\n", "\n-")},
          {"no scale", replaced(pfm, "-1.0", "nan!")},
          {"huge", replaced(pfm, "\n", "\n99999")},
          {"infinite", infinite}};
}

inline std::vector<Corrupted> corrupted_png(const std::string& png, GeneratedWarps* made) {
  std::string flipped = png;
  const std::size_t data = png.find("IDAT");
  CHECK(data != std::string::npos);
  const auto at = data + 4 + static_cast<std::size_t>(made->count(0, static_cast<int>(png.size() - data) - 24));
  flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
  return {{"cut", png.substr(0, static_cast<std::size_t>(made->count(0, static_cast<int>(png.size()) - 8)))},
          {"a bit flipped", flipped},
          {"another format", replaced(png, "PNG", "JPG")}};
}

/// Rewrites an archive with one member changed.
class Repacked {
 public:
  explicit Repacked(const std::string& archive) {
    auto zip = interchange::ZipReader::open(std::as_bytes(std::span(archive)), std::size_t{1} << 30);
    CHECK(zip.has_value());
    for (const std::string& name : zip->names()) {
      auto bytes = zip->read(name);
      CHECK(bytes.has_value());
      members_.push_back({name, *std::move(bytes)});
    }
  }
  [[nodiscard]] std::string text(std::size_t member) const {
    return {reinterpret_cast<const char*>(members_[member].bytes.data()), members_[member].bytes.size()};
  }
  [[nodiscard]] std::string with(std::size_t member, const std::string& text) const {
    std::vector<interchange::ZipMember> members = members_;
    const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
    members[member].bytes.assign(begin, begin + text.size());
    return packed(members);
  }
  [[nodiscard]] std::string renamed(std::size_t member, const std::string& name) const {
    std::vector<interchange::ZipMember> members = members_;
    members[member].name = name;
    return packed(members);
  }
  [[nodiscard]] std::size_t first(std::string_view ending) const {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (members_[i].name.ends_with(ending)) return i;
    }
    return 0;
  }

 private:
  static std::string packed(const std::vector<interchange::ZipMember>& members) {
    const auto zip = interchange::write_zip(members);
    CHECK(zip.has_value());
    return {reinterpret_cast<const char*>(zip->data()), zip->size()};
  }
  std::vector<interchange::ZipMember> members_;
};

inline std::vector<Corrupted> corrupted_mpcdi(const std::string& archive, GeneratedWarps* made) {
  const Repacked parts(archive);
  const std::string xml = parts.text(0);
  const std::size_t map = parts.first(".pfm");
  const std::size_t mask = parts.first(".png");
  std::string flipped = archive;
  const std::size_t member = archive.find("geometry-1.pfm");
  flipped[member + 40] = static_cast<char>(flipped[member + 40] ^ 0x24);  // Inside the compressed data.
  const auto manifest = [&](std::string how, std::string_view old, std::string_view now) {
    return Corrupted{std::move(how), parts.with(0, replaced(xml, old, now))};
  };
  std::vector<Corrupted> all{
      {"cut", archive.substr(0, static_cast<std::size_t>(made->count(0, static_cast<int>(archive.size()) - 1)))},
      {"a byte of a member changed", flipped},
      {"a name that leaves the archive", parts.renamed(map, "../../geometry.pfm")},
      {"an absolute name", parts.renamed(map, "/tmp/geometry.pfm")},
      {"a name twice", parts.renamed(map, "MPCDI.xml")},
      {"a member that lacks", parts.renamed(map, "other.pfm")},
      manifest("no XML", "</MPCDI>", ""),
      manifest("an unknown profile", "profile=\"", "profile=\"x"),
      manifest("an unknown version", ".0\">", ".7\">"),
      manifest("no display", "display>", "screen>"),
      manifest("no id", "<region id=", "<region name="),
      manifest("a width of 0", "esolution=\"", "esolution=\"0 "),
      manifest("no number", " x=\"", " x=\"wide"),
      manifest("outside of the buffer", " y=\"", " y=\"7"),
      manifest("an attribute twice", " y=\"", " Y=\"0\" y=\""),
      manifest("files of no region", "fileset region=\"", "fileset region=\"~"),
      manifest("a path that leaves the archive", "<path>", "<path>../"),
      manifest("two paths", "<path>", "<path>x</path><path>"),
  };
  for (Corrupted& broken : corrupted_pfm(parts.text(map), made)) {
    all.push_back({"a map: " + broken.how, parts.with(map, broken.bytes)});
  }
  if (mask != 0) {
    for (Corrupted& broken : corrupted_png(parts.text(mask), made)) {
      all.push_back({"a mask: " + broken.how, parts.with(mask, broken.bytes)});
    }
  }
  return all;
}

inline std::vector<Corrupted> corrupted_bourke(const std::string& text, GeneratedWarps* made) {
  const auto at = static_cast<std::size_t>(made->count(10, static_cast<int>(text.size()) - 60));
  return {{"no mesh type", replaced(text, "2\n", "7\n")},
          {"no size", with_line(text, 2, "all of them\n")},
          {"a huge size", with_line(text, 2, "2000000000 2000000000\n")},
          {"a line lost", with_line(text, at, "")},
          {"a line more", text + "0 0 0 0 1\n"},
          {"not a number", with_line(text, at, "0 0 nan 0 1\n")},
          {"too few numbers", with_line(text, at, "0 0 0 1\n")},
          {"far away", with_line(text, at, "0 0 1e30 0 1\n")},
          {"too bright", with_line(text, at, "0 0 0 0 5\n")},
          {"empty", ""}};
}

inline std::vector<Corrupted> corrupted_obj(const std::string& text, GeneratedWarps*) {
  const std::size_t vertex = text.find("\nv ") + 1;
  const std::size_t texture = text.find("\nvt ") + 1;
  const std::size_t face = text.find("\nf ") + 1;
  return {{"not flat", with_line(text, vertex, "v 0 0 0.5\n")},
          {"not a number", with_line(text, vertex, "v 0 inf 0\n")},
          {"too few numbers", with_line(text, texture, "vt 0\n")},
          {"a face of absent nodes", with_line(text, face, "f 1/1 2/2 9000001/3\n")},
          {"a face of node 0", with_line(text, face, "f 0/1 2/2 3/3\n")},
          {"a face of two corners", with_line(text, face, "f 1/1 2/2\n")},
          {"an unknown word", with_line(text, face, "surf 1 2 3\n")},
          {"no faces", text.substr(0, face)},
          {"far away", with_line(text, texture, "vt 0 1e9\n")},
          {"empty", ""}};
}

inline std::vector<Corrupted> corrupted_csv(const std::string& text, GeneratedWarps* made) {
  const auto at = static_cast<std::size_t>(made->count(20, static_cast<int>(text.size()) - 60));
  return {{"a line lost", with_line(text, at, "")},
          {"a node twice", text + "0;0;0;0;0;0\n"},
          {"commas", with_line(text, at, "0,5;0;0;0;0;0\n")},
          {"too few fields", with_line(text, at, "0;0;0;0;1\n")},
          {"a negative row", with_line(text, at, "0;0;0;0;0;-1\n")},
          {"a huge grid", text + "0;0;0;0;65535;65535\n"},
          {"not a number", with_line(text, at, "0;nan;0;0;0;0\n")},
          {"empty", ""}};
}

inline std::vector<Corrupted> corrupted_simcad(const std::string& text, GeneratedWarps* made) {
  return {{"cut", text.substr(0, static_cast<std::size_t>(made->count(0, static_cast<int>(text.size()) - 4)))},
          {"another root", replaced(text, "<GeometryFile>", "<Geometry>")},
          {"no range", replaced(text, " range=", " scale=")},
          {"a range of 0", replaced(text, "range=\"", "range=\"0 ")},
          {"a number more", replaced(text, "</X-", " 0</X-")},
          {"not a number", replaced(text, "</Y-", "k</Y-")},
          {"no Y", replaced(replaced(text, "<Y-", "<Z-"), "</Y-", "</Z-")}};
}

}  // namespace cyclorama
