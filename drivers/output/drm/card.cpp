// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/card.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace cyclorama::output {

namespace {

/// True if the card has connectors; a render-only card has none. A card that does not answer is an error, since
/// skipping it would leave its heads dark.
Result<bool> has_connectors(const std::filesystem::path& node) {
  const UniqueFd fd(::open(node.c_str(), O_RDWR | O_CLOEXEC));
  if (!fd.is_open()) return Error::from_errno(fmt::format("opening '{}'", node.string()));
  const KmsResources resources(drmModeGetResources(fd.get()));
  if (resources == nullptr && errno == EOPNOTSUPP) return false;
  if (resources == nullptr) return Error::from_errno(fmt::format("reading the resources of '{}'", node.string()));
  return resources->count_connectors > 0;
}

}  // namespace

bool DrmPlane::can_show(std::uint32_t format) const {
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

Result<Card> Card::open(const std::filesystem::path& path) {
  Card card;
  card.path_ = path;
  card.fd_ = UniqueFd(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (!card.fd_.is_open()) return Error::from_errno(fmt::format("opening '{}'", path.string()));
  // The first process to open a card becomes its master automatically; a later process acquires the right here once the
  // first has closed the card.
  if (drmIsMaster(card.fd()) == 0) {
    if (auto master = card.become_master(); !master) {
      return Error(ErrorCode::kBusy, fmt::format("'{}' belongs to another display server ({}); stop that one",
                                                 path.string(), master.error().message()));
    }
  }
  for (const int wanted : {DRM_CLIENT_CAP_UNIVERSAL_PLANES, DRM_CLIENT_CAP_ATOMIC}) {
    if (const int result = drmSetClientCap(card.fd(), static_cast<std::uint64_t>(wanted), 1); result != 0) {
      const Error why = kms_error(result, fmt::format("'{}' lacks atomic mode setting", path.string()));
      if (is_card_lost(why)) return why;
      return Error(ErrorCode::kUnavailable, why.message());
    }
  }
  std::uint64_t is_monotonic = 0;
  if (const int result = drmGetCap(card.fd(), DRM_CAP_TIMESTAMP_MONOTONIC, &is_monotonic); result != 0)
    return kms_error(result, fmt::format("querying the clock of '{}'", path.string()));
  card.has_monotonic_time_ = is_monotonic != 0;
  TRY(card.read_crtcs());
  TRY(card.read_planes());
  return card;
}

Status Card::become_master() const {
  if (drmSetMaster(fd()) == 0) return Done{};
  return Error::from_errno("taking the card's master right");
}

Status Card::read_crtcs() {
  const KmsResources resources(drmModeGetResources(fd()));
  if (resources == nullptr) return Error::from_errno(fmt::format("reading the resources of '{}'", path_.string()));
  if (resources->count_crtcs == 0 || resources->count_connectors == 0)
    return Error(ErrorCode::kUnavailable, fmt::format("'{}' drives no connectors", path_.string()));
  for (int i = 0; i < resources->count_crtcs; ++i) {
    TRY_ASSIGN(Properties properties, Properties::read(fd(), resources->crtcs[i], DRM_MODE_OBJECT_CRTC));
    crtcs_.push_back({std::move(properties)});
  }
  return Done{};
}

Status Card::read_planes() {
  const KmsPlaneResources resources(drmModeGetPlaneResources(fd()));
  if (resources == nullptr) return Error::from_errno(fmt::format("listing the planes of '{}'", path_.string()));
  for (std::uint32_t i = 0; i < resources->count_planes; ++i) {
    const KmsPlane listed(drmModeGetPlane(fd(), resources->planes[i]));
    if (listed == nullptr) return Error::from_errno(fmt::format("reading plane {}", resources->planes[i]));
    DrmPlane plane;
    TRY_ASSIGN(plane.properties, Properties::read(fd(), listed->plane_id, DRM_MODE_OBJECT_PLANE));
    plane.possible_crtcs = listed->possible_crtcs;
    plane.formats.assign(listed->formats, listed->formats + listed->count_formats);
    const Property* const type = plane.properties.find("type");
    plane.is_primary = type != nullptr && type->value == DRM_PLANE_TYPE_PRIMARY;
    planes_.push_back(std::move(plane));
  }
  return Done{};
}

Result<std::vector<Connector>> Card::read_connectors(const std::function<bool(std::uint32_t)>& is_probed) const {
  const KmsResources resources(drmModeGetResources(fd()));
  if (resources == nullptr) return Error::from_errno(fmt::format("listing the connectors of '{}'", path_.string()));
  std::vector<Connector> connectors;
  for (int i = 0; i < resources->count_connectors; ++i) {
    const std::uint32_t id = resources->connectors[i];
    auto connector = read_connector(fd(), id, is_probed(id));
    if (connector) {
      connectors.push_back(*std::move(connector));
    } else if (connector.error().code() != ErrorCode::kNotFound || is_card_lost(connector.error())) {
      return std::move(connector).error();
    }
  }
  return connectors;
}

Result<std::vector<std::filesystem::path>> list_cards() {
  std::array<drmDevicePtr, 16> devices{};
  const int count = drmGetDevices2(0, devices.data(), static_cast<int>(devices.size()));
  if (count == -ENOENT) return std::vector<std::filesystem::path>();  // The folder of the devices does not exist.
  if (count < 0) return kms_error(count, "listing graphics cards");
  const int listed = std::min(count, static_cast<int>(devices.size()));
  std::vector<std::filesystem::path> nodes;
  for (int i = 0; i < listed; ++i) {
    const drmDevice& device = *devices[static_cast<std::size_t>(i)];
    if ((device.available_nodes >> DRM_NODE_PRIMARY & 1) != 0) nodes.emplace_back(device.nodes[DRM_NODE_PRIMARY]);
  }
  drmFreeDevices(devices.data(), listed);
  std::sort(nodes.begin(), nodes.end());
  std::vector<std::filesystem::path> cards;
  for (const std::filesystem::path& node : nodes) {
    TRY_ASSIGN(const bool has, has_connectors(node));
    if (has) cards.push_back(node);
  }
  return cards;
}

}  // namespace cyclorama::output
