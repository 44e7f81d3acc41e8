// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_file.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "common/base/check.h"
#include "common/base/file.h"

namespace cyclorama::light {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are in memory");
static_assert(sizeof(LightCheck) == std::size_t{22} * 4 && std::is_trivially_copyable_v<LightCheck>,
              "it is written as it is, too");

constexpr std::string_view kMagic = "CYCLIGHT";
constexpr std::uint32_t kFileVersion = 3;
constexpr std::uint32_t kMaxSettings = 4096;

class Writer {
 public:
  void add(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  template <typename Value>
  void add_value(const Value& value) {
    add(std::as_bytes(std::span(&value, 1)));
  }
  void add_size(std::size_t size) { add_value(static_cast<std::uint32_t>(size)); }
  template <typename Value>
  void add_array(const std::vector<Value>& array) {
    add(std::as_bytes(std::span(array)));
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads values one after another. A read beyond the end fails.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <typename Value>
  [[nodiscard]] bool read(Value* ret) {
    if (rest_.size() < sizeof(Value)) return false;
    std::memcpy(ret, rest_.data(), sizeof(Value));
    rest_ = rest_.subspan(sizeof(Value));
    return true;
  }
  [[nodiscard]] bool read_text(std::size_t size, std::string* ret) {
    if (rest_.size() < size) return false;
    ret->resize(size);
    std::memcpy(ret->data(), rest_.data(), size);
    rest_ = rest_.subspan(size);
    return true;
  }
  template <typename Value>
  [[nodiscard]] bool read_array(std::size_t size, std::vector<Value>* ret) {
    if (rest_.size() / sizeof(Value) < size) return false;
    ret->resize(size);
    if (size > 0) std::memcpy(ret->data(), rest_.data(), size * sizeof(Value));
    rest_ = rest_.subspan(size * sizeof(Value));
    return true;
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
};

Error damaged(std::string_view name, std::string_view what) {
  return Error(ErrorCode::kBadData,
               fmt::format("{}: {}; delete the file, and 'cyclorama-render light SCENE' makes it anew", name, what));
}

/// Returns true if the samples of every grid are within `light.samples`.
bool grids_fit(const SideLight& light) {
  for (const std::uint32_t code : light.grids) {
    if (code == TriangleGrid::kBase || code == TriangleGrid::kTraced) continue;
    if (code >> 28 == 0 || TriangleGrid::parts(code) > TriangleGrid::kMaxParts) return false;
    const auto count = static_cast<std::size_t>(TriangleGrid::samples(TriangleGrid::parts(code)));
    if (TriangleGrid::offset(code) + count > light.samples.size()) return false;
  }
  return true;
}

struct SideSizes {
  std::array<std::uint32_t, 4> count{};
};

bool read_surfaces(Reader& reader, std::uint32_t placements, LightStore* ret) {
  constexpr std::size_t kHeaderBytes = 9 * sizeof(std::uint32_t);
  if (reader.left() / kHeaderBytes < placements) return false;  // Checked before memory is allocated.
  ret->surfaces.resize(placements);
  std::vector<std::array<SideSizes, 2>> sizes(placements);
  for (std::size_t i = 0; i < placements; ++i) {
    std::uint32_t per_triangle = 0;
    if (!reader.read(&per_triangle) || !reader.read(&sizes[i])) return false;
    ret->surfaces[i].base_per_triangle = per_triangle != 0;
  }
  for (std::size_t i = 0; i < placements; ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      SideLight& light = ret->surfaces[i].sides[side];
      const std::array<std::uint32_t, 4>& count = sizes[i][side].count;
      if (!reader.read_array(count[0], &light.base) || !reader.read_array(count[1], &light.directions) ||
          !reader.read_array(count[2], &light.grids) || !reader.read_array(count[3], &light.samples) ||
          !reader.read_array(count[0], &light.base_errors) || !reader.read_array(count[3], &light.sample_errors)) {
        return false;
      }
    }
  }
  return true;
}

/// Reads the light of each group of lamps after that of everything else.
bool read_groups(Reader& reader, std::uint32_t placements, LightStore* ret) {
  std::uint32_t groups = 0;
  if (!reader.read(&groups) || groups >= scene::kMaxLampGroups) return false;
  ret->groups.resize(groups);
  for (LightStore& group : ret->groups) {
    if (!reader.read(&group.unit)) return false;
  }
  if (!read_surfaces(reader, placements, ret)) return false;
  return std::ranges::all_of(ret->groups, [&](LightStore& group) { return read_surfaces(reader, placements, &group); });
}

/// Returns what is wrong with the values of a store whose lengths fit; empty if nothing is.
std::string_view fault_of(const LightStore& store) {
  if (!(store.unit > 0.0f && std::isfinite(store.unit))) return "the unit of its samples is not positive";
  for (const SurfaceLight& surface : store.surfaces) {
    for (const SideLight& side : surface.sides) {
      if (!grids_fit(side)) return "a triangle's samples lie outside the file";
    }
  }
  for (const LightStore& group : store.groups) {
    if (const std::string_view fault = fault_of(group); !fault.empty()) return fault;
  }
  return "";
}

void add_surfaces(const LightStore& store, Writer* writer) {
  for (const SurfaceLight& surface : store.surfaces) {
    writer->add_value(std::uint32_t{surface.base_per_triangle ? 1u : 0u});
    for (const SideLight& side : surface.sides) {
      writer->add_size(side.base.size());
      writer->add_size(side.directions.size());
      writer->add_size(side.grids.size());
      writer->add_size(side.samples.size());
    }
  }
  for (const SurfaceLight& surface : store.surfaces) {
    for (const SideLight& side : surface.sides) {
      writer->add_array(side.base);
      writer->add_array(side.directions);
      writer->add_array(side.grids);
      writer->add_array(side.samples);
      CHECK(side.base_errors.size() == side.base.size() && side.sample_errors.size() == side.samples.size());
      writer->add_array(side.base_errors);
      writer->add_array(side.sample_errors);
    }
  }
}

/// Returns what does not fit placements in the surfaces of one group; empty if all fits.
std::string misfit_of(const LightStore& store, const std::vector<PlacementSize>& placements) {
  if (store.surfaces.size() != placements.size()) return "another number of meshes than the scene has";
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const SurfaceLight& surface = store.surfaces[i];
    const std::size_t base = surface.base_per_triangle ? placements[i].triangles : placements[i].vertices;
    for (const SideLight& side : surface.sides) {
      if ((!side.base.empty() && side.base.size() != base) ||
          (!side.directions.empty() && side.directions.size() != side.base.size()) ||
          (!side.grids.empty() && (side.base.empty() || side.grids.size() != placements[i].triangles))) {
        return fmt::format("mesh {} has another number of samples than vertices", i);
      }
    }
  }
  return "";
}

}  // namespace

std::vector<std::byte> light_file_bytes(const LightStore& store) {
  Writer writer;
  writer.reserve(store.bytes() + 4096 + 32 * store.surfaces.size());
  writer.add(std::as_bytes(std::span(kMagic)));
  writer.add_value(kFileVersion);
  writer.add_size(store.surfaces.size());
  writer.add_value(store.scene);
  writer.add_value(store.unit);
  const std::string_view settings = std::string_view(store.settings).substr(0, kMaxSettings);
  writer.add_size(settings.size());
  writer.add(std::as_bytes(std::span(settings)));
  writer.add_value(store.check);
  writer.add_size(store.groups.size());
  for (const LightStore& group : store.groups) writer.add_value(group.unit);
  add_surfaces(store, &writer);
  for (const LightStore& group : store.groups) add_surfaces(group, &writer);
  const std::uint64_t checksum = XXH3_64bits(writer.bytes().data(), writer.bytes().size());
  writer.add_value(checksum);
  return writer.take();
}

Result<LightStore> parse_light_file(std::span<const std::byte> bytes, std::string_view name) {
  std::string magic;
  std::uint32_t version = 0;
  Reader reader(bytes);
  if (!reader.read_text(kMagic.size(), &magic) || magic != kMagic) return damaged(name, "not a file of stored light");
  if (!reader.read(&version)) return damaged(name, "the file ends early");
  if (version != kFileVersion) {
    return damaged(name,
                   fmt::format("stored light of version {}, but this program reads version {}", version, kFileVersion));
  }
  std::uint64_t checksum = 0;
  if (bytes.size() < sizeof(checksum)) return damaged(name, "the file ends early");
  const std::span<const std::byte> content = bytes.first(bytes.size() - sizeof(checksum));
  std::memcpy(&checksum, bytes.data() + content.size(), sizeof(checksum));
  if (checksum != XXH3_64bits(content.data(), content.size())) {
    return damaged(name, "the file is damaged: its checksum does not match");
  }
  reader = Reader(content.subspan(kMagic.size() + sizeof(version)));
  LightStore store;
  std::uint32_t placements = 0;
  std::uint32_t settings = 0;
  if (!reader.read(&placements) || !reader.read(&store.scene) || !reader.read(&store.unit) || !reader.read(&settings) ||
      settings > kMaxSettings || !reader.read_text(settings, &store.settings) || !reader.read(&store.check) ||
      !read_groups(reader, placements, &store) || !reader.at_end()) {
    return damaged(name, "the lengths in the file do not match its size");
  }
  if (const std::string_view fault = fault_of(store); !fault.empty()) return damaged(name, fault);
  return store;
}

Result<LightStore> read_light_file(const std::filesystem::path& path) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  return parse_light_file(file.bytes(), path.string());
}

Status write_light_file(const std::filesystem::path& path, const LightStore& store) {
  return write_file_atomically(path, light_file_bytes(store));
}

Status check_fits(const LightStore& store, const SceneKey& scene, const std::vector<PlacementSize>& placements,
                  std::string_view name) {
  if (!(store.scene == scene)) {
    return damaged(name, "this light belongs to another scene, or the scene has changed since it was computed");
  }
  if (std::string misfit = misfit_of(store, placements); !misfit.empty()) return damaged(name, misfit);
  for (const LightStore& group : store.groups) {
    if (std::string misfit = misfit_of(group, placements); !misfit.empty()) return damaged(name, misfit);
  }
  return Done{};
}

}  // namespace cyclorama::light
