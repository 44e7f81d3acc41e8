// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/connector.h"

#include <fmt/format.h>

#include <algorithm>

namespace cyclorama::output {
namespace {

constexpr std::uint64_t kLinkBad = 1;  // DRM_MODE_LINK_STATUS_BAD from libdrm's drm_mode.h.

std::vector<std::uint8_t> blob_bytes(int fd, const Property* property) {
  if (property == nullptr || property->value == 0) return {};
  // A blob that has vanished belonged to a projector that is gone; treat it as a missing EDID.
  const KmsBlob blob(drmModeGetPropertyBlob(fd, static_cast<std::uint32_t>(property->value)));
  if (blob == nullptr || blob->data == nullptr) return {};
  const auto* const bytes = static_cast<const std::uint8_t*>(blob->data);
  return {bytes, bytes + blob->length};
}

}  // namespace

int Connector::colour_bits() const {
  constexpr int kUsual = 8;
  const Property* const max = properties.find("max bpc");
  if (max == nullptr || !edid || edid->colour_bits == 0) return kUsual;
  return std::min(static_cast<int>(max->max), edid->colour_bits);
}

bool Connector::is_same_as(const Connector& other) const {
  return is_connected == other.is_connected && is_link_bad == other.is_link_bad && edid_bytes == other.edid_bytes &&
         std::equal(modes.begin(), modes.end(), other.modes.begin(), other.modes.end(),
                    [](const drmModeModeInfo& a, const drmModeModeInfo& b) {
                      return a.clock == b.clock && a.hdisplay == b.hdisplay && a.vdisplay == b.vdisplay &&
                             a.htotal == b.htotal && a.vtotal == b.vtotal && a.flags == b.flags;
                    });
}

Result<Connector> read_connector(int fd, std::uint32_t id, bool is_probed) {
  const KmsConnector found(is_probed ? drmModeGetConnector(fd, id) : drmModeGetConnectorCurrent(fd, id));
  if (found == nullptr) return Error::from_errno(fmt::format("reading connector {}", id));
  Connector connector;
  const char* const type = drmModeGetConnectorTypeName(found->connector_type);
  connector.name = fmt::format("{}-{}", type == nullptr ? "Unknown" : type, found->connector_type_id);
  connector.is_connected = found->connection == DRM_MODE_CONNECTED;
  connector.modes.assign(found->modes, found->modes + found->count_modes);
  connector.possible_crtcs = drmModeConnectorGetPossibleCrtcs(fd, found.get());
  if (connector.is_connected && connector.possible_crtcs == 0)
    return Error::from_errno(fmt::format("reading the possible CRTCs of {}", connector.name));
  auto properties = Properties::read(fd, id, DRM_MODE_OBJECT_CONNECTOR);
  if (!properties) return std::move(properties).error().while_doing(connector.name);
  connector.properties = *std::move(properties);
  const Property* const link = connector.properties.find("link-status");
  connector.is_link_bad = link != nullptr && link->value == kLinkBad;
  if (connector.is_connected) connector.edid_bytes = blob_bytes(fd, connector.properties.find("EDID"));
  if (auto edid = parse_edid(connector.edid_bytes)) {
    connector.edid = *std::move(edid);
  } else if (connector.is_connected) {
    connector.edid_fault =
        connector.edid_bytes.empty() ? "no EDID: check the cable, or set 'edid'" : edid.error().message();
  }
  return connector;
}

}  // namespace cyclorama::output
