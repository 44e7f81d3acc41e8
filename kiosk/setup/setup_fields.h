// SPDX-License-Identifier: Apache-2.0
/// The steps of the installer's way: what people type, judged while they type it, and turned into settings.
#pragma once

#include <string>
#include <vector>

#include "common/network/network_settings.h"
#include "kiosk/setup/room_plan.h"
#include "kiosk/setup/setup_draft.h"

namespace cyclorama::setup {

/// Names of the steps whose fields are kept, in their order.
inline constexpr const char* kNameStep = "name";
inline constexpr const char* kNetworkStep = "network";
inline constexpr const char* kProjectorsStep = "projectors";
inline constexpr const char* kWallStep = "wall";
inline constexpr const char* kCamerasStep = "cameras";
inline constexpr const char* kFarmStep = "farm";
inline constexpr const char* kTourStep = "tour";
[[nodiscard]] const std::vector<std::string>& field_steps();

struct FieldProblem {
  std::string field;     ///< Name of a field; empty: the step as a whole.
  std::string sentence;  ///< For people, with the remedy.
};

/// A projector's socket with what is plugged in.
struct PluggedProjector {
  std::string connector;  ///< "HDMI-A-1".
  std::string text;       ///< "EPS EB-L1755U"; empty: it does not say.
  int width_px = 1920;
  int height_px = 1080;
};

/// Devices of this computer. A value.
struct SetupFacts {
  std::vector<PluggedProjector> plugged{};
  std::vector<std::string> cables{};   ///< Names of the network's sockets.
  std::vector<std::string> cameras{};  ///< Ports of cameras.
};

/// Returns the mistakes in one step's fields; `all` has the drafts of the other steps.
[[nodiscard]] std::vector<FieldProblem> problems_of(const std::string& step,
                                                    const std::map<std::string, StepDraft>& all,
                                                    const SetupFacts& facts);

/// Conversions; what does not parse keeps its default, since problems_of() reports it.
[[nodiscard]] NetworkSettings network_of(const Fields& fields);
[[nodiscard]] Fields fields_of(const NetworkSettings& network);
[[nodiscard]] RoomPlan plan_of(const Fields& projectors, const Fields& wall, const SetupFacts& facts);
/// Returns the texts between commas or blanks: "192.0.2.1, 192.0.2.2".
[[nodiscard]] std::vector<std::string> list_in(const std::string& text);
[[nodiscard]] std::string text_in(const Fields& fields, const std::string& name);

}  // namespace cyclorama::setup
