// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/make_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/text.h"
#include "drivers/output/drm/connector_assignment.h"

namespace cyclorama::display {
namespace {

constexpr std::array<output::Rotation, 4> kTurns{output::Rotation::kNone, output::Rotation::kQuarter,
                                                 output::Rotation::kHalf, output::Rotation::kThreeQuarters};

output::HeadMode mode_of(const InstalledProjector& projector) {
  return {projector.name, projector.lens.width_px, projector.lens.height_px};
}

output::Rotation rotation_of(int turn_deg) {
  CHECK(turn_deg >= 0 && turn_deg <= 270 && turn_deg % 90 == 0);
  return kTurns[static_cast<std::size_t>(turn_deg / 90)];
}

Result<output::DrmHead> head_of(const InstalledProjector& projector) {
  const Plug& plug = projector.plug;
  output::DrmHead head{mode_of(projector),
                       plug.card ? fmt::format("{}:{}", *plug.card, plug.connector) : plug.connector,
                       rotation_of(plug.turn_deg), plug.serial};
  if (!plug.edid.empty()) {
    TRY_ASSIGN(head.edid, read_edid_to_drive(plug.edid));
    head.is_always_connected = plug.is_always_connected;
  }
  return head;
}

}  // namespace

Result<output::DrmOptions> drm_options(const OutputChoice& choice, const Installation& installation,
                                       double refresh_hz) {
  output::DrmOptions options;
  options.refresh_hz = refresh_hz;
  options.cards = choice.cards.empty() ? installation.cards : choice.cards;
  options.is_awake = choice.is_awake;
  for (const InstalledProjector& projector : installation.projectors) {
    TRY_ASSIGN(output::DrmHead head, head_of(projector));
    options.heads.push_back(std::move(head));
  }
  for (const OutputChoice::Head& head : choice.heads) {
    const auto found = std::find_if(options.heads.begin(), options.heads.end(),
                                    [&](const output::DrmHead& h) { return h.mode.name == head.projector; });
    if (found == options.heads.end()) {
      return Error(ErrorCode::kInvalidArgument,
                   fmt::format("head '{}' is no projector of this installation; use a [[projector]]'s name",
                               printable(head.projector)));
    }
    found->connector = head.connector;
    found->serial.clear();
    found->rotation = head.rotation;
  }
  return options;
}

Result<OutputChoice::Head> parse_head(std::string_view text) {
  const std::size_t equals = text.rfind('=');
  const Error wrong(ErrorCode::kInvalidArgument,
                    fmt::format("head '{}': write PROJECTOR=CONNECTOR, such as left=HDMI-A-1, or left=HDMI-A-1,90 to "
                                "turn it clockwise by 90, 180 or 270 degrees",
                                printable(text)));
  if (equals == std::string_view::npos || equals == 0) return wrong;
  OutputChoice::Head head;
  head.projector = text.substr(0, equals);
  std::string_view position = text.substr(equals + 1);
  if (const std::size_t comma = position.find(','); comma != std::string_view::npos) {
    const auto degrees = parse_integer(position.substr(comma + 1));
    if (!degrees || *degrees < 0 || *degrees > 270 || *degrees % 90 != 0) return wrong;
    head.rotation = rotation_of(static_cast<int>(*degrees));
    position = position.substr(0, comma);
  }
  head.connector = position;
  TRY(output::parse_connector_preference(head.connector));
  return head;
}

Result<std::unique_ptr<output::Output>> make_output(const OutputChoice& choice, const Installation& installation,
                                                    double refresh_hz, const Clock& clock) {
  if (choice.kind == OutputChoice::Kind::kDrm) {
    TRY_ASSIGN(const output::DrmOptions drm, drm_options(choice, installation, refresh_hz));
    return output::open_drm_output(drm, clock);
  }
  output::HeadlessOptions options;
  for (const InstalledProjector& projector : installation.projectors) options.heads.push_back(mode_of(projector));
  options.refresh_hz = refresh_hz;
  options.run_dir = choice.run_dir;
  options.renderer = choice.renderer;
  options.is_awake = choice.is_awake;
  return output::open_headless_output(options, clock);
}

}  // namespace cyclorama::display
