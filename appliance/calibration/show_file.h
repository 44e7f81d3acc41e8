// SPDX-License-Identifier: Apache-2.0
/// Where everything stands while the show goes on, as the continuous calibration keeps it beside calibration.json:
///
///     FOLDER/watch.json        the calibrator's own: fixed cameras, and all it needs to go on after a restart
///     FOLDER/correction.json   what displays correct their maps by (corrected_map.h): no cameras
///
/// Both are replaced by a rename, so whole or not at all, and belong to the calibration of one date: of another they
/// are nobody's. `scanned` is where a projector's map, the wall and its lens say that it stood when the wall was
/// measured; only the way from there to `applied` counts.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/calibration/pose_step.h"
#include "appliance/calibration/show_calibration.h"

namespace cyclorama::calibration {

/// A value.
struct ShowFile {
  struct Projector {
    std::string name;
    BrownParameters lens;
    RigidTransform<frame::Room, frame::Projector> scanned;
    RigidTransform<frame::Room, frame::Projector> applied;
    /// Once the continuous calibration has learned what the scan left over.
    struct Learned {
      RigidTransform<frame::Room, frame::Projector> believed;  ///< Where it is believed to stand.
      RigidTransform<frame::Room, frame::Projector> at_rest;   ///< Where it would be if `applied` were right.
      PoseMatrix root;                                         ///< How sure that is, as PoseFilter::root().
    };
    std::optional<Learned> learned{};
    std::string unplaced{};  ///< As ShowProjector::unplaced; `scanned` is then where it was installed.
    /// Per channel, as rounded_light() has it; nothing: not measured.
    std::optional<std::array<CodeLight, 3>> light{};
  };
  struct Camera {
    std::string name;
    BrownParameters lens;
    RigidTransform<frame::Room, frame::Camera> T_room_camera;
    std::optional<PoseMatrix> root{};  ///< How sure that is, once it was learned.
  };
  std::string calibration;  ///< Its date.
  std::vector<Projector> projectors;
  std::vector<Camera> cameras;
};

inline constexpr const char* kWatchFile = "watch.json";
inline constexpr const char* kCorrectionFile = "correction.json";

[[nodiscard]] std::string show_json(const ShowFile& show);
/// The opposite. `name` stands for the file in errors. kBadData  "watch.json: /projectors/0/lens: ...; remedy".
Result<ShowFile> parse_show(std::string_view text, const std::string& name);
/// Others as read_text_file().
Result<ShowFile> read_show(const std::filesystem::path& path);
/// Errors as write_file_atomically().
Status write_show(const std::filesystem::path& path, const ShowFile& show);

}  // namespace cyclorama::calibration
