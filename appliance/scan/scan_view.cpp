// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/scan_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/json/strict_json.h"

namespace cyclorama::scan {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr int kMaxPx = 16384;
constexpr std::size_t kMaxProjectors = 256;
constexpr std::size_t kMaxDirections = 4096;
constexpr std::size_t kMaxCorrespondences = 32'000'000;
constexpr std::size_t kManifestLimit = 4 << 20;
constexpr std::string_view kMagic = "cyclorama view 1";  // 16 bytes.
constexpr std::size_t kCorrespondenceBytes = 5 * sizeof(float);
constexpr auto kStale = std::chrono::hours(12);
constexpr const char* kManifest = "manifest.json";
constexpr const char* kAnew = "; calibrate again, without resuming";
static_assert(std::endian::native == std::endian::little, "places are written as they lie in memory");

/// 64-bit FNV-1a: detects damage, not manipulation.
std::string checksum_of(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 0x100000001b3u;
  return fmt::format("{:016x}", hash);
}

Error bad(std::string what) { return {ErrorCode::kBadData, what + kAnew}; }

std::filesystem::path file_of(const std::filesystem::path& folder, const ScanView& view) {
  return folder / fmt::format("{}-{}.view", view.direction, view.projector);
}

ScanView without_correspondences(const ScanView& view) {
  return {view.direction, view.projector, view.angle_rad, view.exposure_s, view.disturbed, view.pictures, {}};
}

std::string difference(const ScanIdentity& kept, const ScanIdentity& now) {
  if (kept.camera != now.camera) {
    return fmt::format("it was photographed by camera '{}', and this is '{}'", printable(kept.camera),
                       printable(now.camera));
  }
  if (kept.camera_width_px != now.camera_width_px || kept.camera_height_px != now.camera_height_px) {
    return fmt::format("its photographs had {}x{} pixels, the camera has {}x{}", kept.camera_width_px,
                       kept.camera_height_px, now.camera_width_px, now.camera_height_px);
  }
  if (kept.projectors != now.projectors) return "it is of other projectors";
  if (kept.angles_rad != now.angles_rad) return "it looked in other directions";
  return "it showed other patterns";
}

ScanIdentity identity_of(StrictJson json) {
  ScanIdentity identity;
  identity.camera = json.text("camera");
  identity.camera_width_px = json.integer("camera_width_px", 1, kMaxPx);
  identity.camera_height_px = json.integer("camera_height_px", 1, kMaxPx);
  for (StrictJson& element : json.list("projectors", 1, kMaxProjectors)) {
    ScanIdentity::Projector projector;
    projector.name = element.text("name");
    projector.width_px = element.integer("width_px", 1, kMaxPx);
    projector.height_px = element.integer("height_px", 1, kMaxPx);
    element.refuse_other_keys();
    identity.projectors.push_back(std::move(projector));
  }
  identity.angles_rad = json.numbers("angles_rad", 1, kMaxDirections);
  identity.patterns = json.text("patterns");
  json.refuse_other_keys();
  return identity;
}

ScanManifest::Entry entry_of(StrictJson json, const ScanIdentity& identity) {
  ScanManifest::Entry entry;
  const auto last = [](std::size_t count) { return static_cast<int>(std::max<std::size_t>(count, 1) - 1); };
  entry.view.direction = static_cast<std::size_t>(json.integer("direction", 0, last(identity.angles_rad.size())));
  entry.view.projector = static_cast<std::size_t>(json.integer("projector", 0, last(identity.projectors.size())));
  entry.view.angle_rad = json.number("angle_rad", -100.0, 100.0);
  entry.view.exposure_s = json.number("exposure_s", 0.0, 60.0);
  entry.view.disturbed = json.number("disturbed", 0.0, 1.0);
  entry.view.pictures = json.integer("pictures", 0, 1'000'000);
  entry.correspondences =
      static_cast<std::size_t>(json.integer("correspondences", 0, static_cast<int>(kMaxCorrespondences)));
  entry.checksum = json.text("checksum", 16);
  json.refuse_other_keys();
  return entry;
}

}  // namespace

std::string manifest_text(const ScanManifest& manifest) {
  const ScanIdentity& identity = manifest.identity;
  Json projectors = Json::array();
  for (const auto& p : identity.projectors) {
    projectors.push_back({{"name", p.name}, {"width_px", p.width_px}, {"height_px", p.height_px}});
  }
  Json views = Json::array();
  for (const ScanManifest::Entry& entry : manifest.entries) {
    const ScanView& view = entry.view;
    views.push_back({{"direction", view.direction},
                     {"projector", view.projector},
                     {"angle_rad", view.angle_rad},
                     {"exposure_s", view.exposure_s},
                     {"disturbed", view.disturbed},
                     {"pictures", view.pictures},
                     {"correspondences", entry.correspondences},
                     {"checksum", entry.checksum}});
  }
  const Json json = {{"version", kVersion},
                     {"scan",
                      {{"camera", identity.camera},
                       {"camera_width_px", identity.camera_width_px},
                       {"camera_height_px", identity.camera_height_px},
                       {"projectors", std::move(projectors)},
                       {"angles_rad", identity.angles_rad},
                       {"patterns", identity.patterns}}},
                     {"views", std::move(views)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<ScanManifest> parse_manifest(std::string_view text, const std::string& name) {
  const nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
  if (document.is_discarded()) return bad(name + " is no JSON");
  StrictJson::Mistakes mistakes("calibrate again");
  StrictJson json(document, &mistakes);
  ScanManifest manifest;
  json.require_version(kVersion);
  manifest.identity = identity_of(json.at("scan"));
  for (StrictJson& element : json.list("views", 0, kMaxDirections * kMaxProjectors)) {
    manifest.entries.push_back(entry_of(element, manifest.identity));
  }
  json.refuse_other_keys();
  if (mistakes.is_any) return bad(name + ": " + printable(mistakes.first, 400));
  return manifest;
}

std::vector<std::byte> encode_correspondences(std::span<const solve::Correspondence> correspondences) {
  std::vector<std::byte> bytes(kMagic.size() + correspondences.size() * kCorrespondenceBytes);
  std::memcpy(bytes.data(), kMagic.data(), kMagic.size());
  std::byte* to = bytes.data() + kMagic.size();
  for (const solve::Correspondence& c : correspondences) {
    const float numbers[5] = {c.camera_u, c.camera_v, c.projector_x, c.projector_y, c.sigma_px};
    std::memcpy(to, numbers, kCorrespondenceBytes);
    to += kCorrespondenceBytes;
  }
  return bytes;
}

Result<std::vector<solve::Correspondence>> decode_correspondences(std::span<const std::byte> bytes,
                                                                  const ScanIdentity& identity, std::size_t projector) {
  if (bytes.size() < kMagic.size() || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0 ||
      (bytes.size() - kMagic.size()) % kCorrespondenceBytes != 0) {
    return bad("it holds no view");
  }
  const ScanIdentity::Projector& format = identity.projectors.at(projector);
  const auto is_within = [](float value, int size) { return value >= 0.0f && value <= static_cast<float>(size); };
  // A camera position must lie in an existing pixel, so its upper bound is exclusive.
  const auto is_pixel = [](float value, int size) { return value >= 0.0f && value < static_cast<float>(size); };
  std::vector<solve::Correspondence> correspondences((bytes.size() - kMagic.size()) / kCorrespondenceBytes);
  const std::byte* from = bytes.data() + kMagic.size();
  for (solve::Correspondence& c : correspondences) {
    float numbers[5];
    std::memcpy(numbers, from, kCorrespondenceBytes);
    from += kCorrespondenceBytes;
    c = {numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], static_cast<std::uint32_t>(projector)};
    if (!is_pixel(c.camera_u, identity.camera_width_px) || !is_pixel(c.camera_v, identity.camera_height_px) ||
        !is_within(c.projector_x, format.width_px) || !is_within(c.projector_y, format.height_px) ||
        !(c.sigma_px > 0.0f && c.sigma_px < 1e6f)) {
      return bad("it contains a position outside of the pictures");
    }
  }
  return correspondences;
}

Result<ScanFolder> ScanFolder::begin(std::filesystem::path folder, const ScanIdentity& identity) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("making '{}': {}", folder.string(), error.message()));
  // The manifest is removed first: views without a manifest are not a scan.
  std::filesystem::remove(folder / kManifest, error);
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (at->path().extension() == ".view") std::filesystem::remove(at->path(), ignored);
  }
  ScanFolder scan(std::move(folder), identity);
  TRY(write_file_atomically(scan.folder_ / kManifest, manifest_text(scan.manifest_)));
  return scan;
}

Result<ScanFolder> ScanFolder::resume(std::filesystem::path folder, const ScanIdentity& identity) {
  const std::filesystem::path path = folder / kManifest;
  auto text = read_text_file(path, kManifestLimit);
  if (!text) {
    if (text.error().code() != ErrorCode::kNotFound) return std::move(text).error();
    return Error(ErrorCode::kNotFound, fmt::format("there is nothing to go on with in '{}'{}", folder.string(), kAnew));
  }
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error);
  if (!error && std::filesystem::file_time_type::clock::now() - written > kStale) {
    return bad(fmt::format("the scan in '{}' was left alone for more than {} hours, in which projectors may have moved",
                           folder.string(), std::chrono::hours(kStale).count()));
  }
  TRY_ASSIGN(ScanManifest manifest, parse_manifest(*text, path.string()));
  if (!(manifest.identity == identity)) {
    return bad(fmt::format("the scan in '{}' cannot be resumed: {}", folder.string(),
                           difference(manifest.identity, identity)));
  }
  ScanFolder scan(std::move(folder), identity);
  for (const ScanManifest::Entry& entry : manifest.entries) {
    const std::filesystem::path file = file_of(scan.folder_, entry.view);
    auto bytes = read_file(file, kMagic.size() + kMaxCorrespondences * kCorrespondenceBytes);
    if (!bytes)
      return bad(fmt::format("the scan in '{}' is damaged: {}", scan.folder_.string(), bytes.error().message()));
    if (checksum_of(*bytes) != entry.checksum) return bad(fmt::format("'{}' is damaged", file.string()));
    auto correspondences = decode_correspondences(*bytes, identity, entry.view.projector);
    if (!correspondences)
      return std::move(correspondences).error().while_doing(fmt::format("reading '{}'", file.string()));
    if (correspondences->size() != entry.correspondences) return bad(fmt::format("'{}' is damaged", file.string()));
    scan.views_.push_back(entry.view);
    scan.views_.back().correspondences = *std::move(correspondences);
  }
  scan.manifest_ = std::move(manifest);
  return scan;
}

void ScanFolder::end(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(folder / kManifest, ignored);
}

const ScanView* ScanFolder::find(std::size_t direction, std::size_t projector) const {
  for (const ScanView& view : views_) {
    if (view.direction == direction && view.projector == projector) return &view;
  }
  return nullptr;
}

Status ScanFolder::keep(ScanView view) {
  const std::vector<std::byte> bytes = encode_correspondences(view.correspondences);
  TRY(write_file_atomically(file_of(folder_, view), bytes));
  ScanManifest::Entry entry{without_correspondences(view), view.correspondences.size(), checksum_of(bytes)};
  const auto is_same = [&](const ScanView& other) {
    return other.direction == view.direction && other.projector == view.projector;
  };
  std::erase_if(manifest_.entries, [&](const ScanManifest::Entry& other) { return is_same(other.view); });
  std::erase_if(views_, is_same);
  manifest_.entries.push_back(std::move(entry));
  views_.push_back(std::move(view));
  return write_file_atomically(folder_ / kManifest, manifest_text(manifest_));
}

}  // namespace cyclorama::scan
