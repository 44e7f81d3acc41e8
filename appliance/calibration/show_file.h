// SPDX-License-Identifier: Apache-2.0
/// The poses of the continuous calibration, which keeps them beside calibration.json during the show:
///
///     FOLDER/watch.json        for the calibrator itself: fixed cameras, and all data to resume from after a restart
///     FOLDER/correction.json   for displays, which correct their maps with it (corrected_map.h): no cameras
///
/// Both are replaced atomically by renaming. They belong to the calibration of one date and are ignored with any other.
/// `scanned` is the projector's pose at the time of the scan, according to its map, the wall and its lens; only the
/// motion from `scanned` to `applied` matters.
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

/// Contents of watch.json or correction.json. A value.
struct ShowFile {
  struct Projector {
    std::string name;
    BrownParameters lens;
    RigidTransform<frame::Room, frame::Projector> scanned;
    RigidTransform<frame::Room, frame::Projector> applied;
    /// Present once the continuous calibration has estimated the scan's residual error.
    struct Learned {
      RigidTransform<frame::Room, frame::Projector> believed;  ///< The pose as estimated.
      /// Pose that would be estimated if `applied` were exact.
      RigidTransform<frame::Room, frame::Projector> at_rest;
      /// Square root of the covariance; see PoseFilter::root().
      PoseMatrix root;
    };
    std::optional<Learned> learned{};
    std::string unplaced{};  ///< See ShowProjector::unplaced. If it is not empty, `scanned` is the installed pose.
    /// Light per channel, rounded by rounded_light(); absent if not measured.
    std::optional<std::array<CodeLight, 3>> light{};
  };
  struct Camera {
    std::string name;
    BrownParameters lens;
    RigidTransform<frame::Room, frame::Camera> T_room_camera;
    std::optional<PoseMatrix> root{};  ///< Square root of the pose's covariance; absent until it is estimated.
  };
  std::string calibration;  ///< Date of the calibration.
  std::vector<Projector> projectors;
  std::vector<Camera> cameras;
};

inline constexpr const char* kWatchFile = "watch.json";
inline constexpr const char* kCorrectionFile = "correction.json";

[[nodiscard]] std::string show_json(const ShowFile& show);
/// Inverse of show_json(). `name` stands for the file in errors. Errors: kBadData, such as "watch.json:
/// /projectors/0/lens: ...; remedy".
Result<ShowFile> parse_show(std::string_view text, const std::string& name);
/// Reads watch.json or correction.json. Errors: those of read_text_file() and parse_show().
Result<ShowFile> read_show(const std::filesystem::path& path);
/// Writes watch.json or correction.json. Errors: those of write_file_atomically().
Status write_show(const std::filesystem::path& path, const ShowFile& show);

}  // namespace cyclorama::calibration
