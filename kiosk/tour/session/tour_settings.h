// SPDX-License-Identifier: Apache-2.0
/// A museum's settings, site.toml, read strictly. Without a file every setting has its default.
///
///   # site.toml
///   [farm]
///   coordinators = ["[2001:db8::1]:7401"]
///   scene = "grotto"                     # Empty: the first one.
///   museum = "Hall 3"
///   authority = "tls/authority.crt"      # All three or none; without them the connection is not encrypted.
///   certificate = "tls/certificate.crt"  # Relative to site.toml's folder.
///   key = "tls/key.pem"
///   [walk]
///   forward_m_per_s = 1.0
///   turn_deg_per_s = 40
///   neutral_distance_m = 1.0
///   guide_after_s = 45                   # 0: never.
///   max_turn_minutes = 0                 # Limit of one visitor's turn where others queue; 0: none.
///   [picture]
///   frame_budget_ms = 150                # The farm chooses a quality that fits, and refines at rest
///   reference_samples = 1024             # up to this many samples per pixel.
///   guard_deg = 8
///   [tour]
///   folder = "tour"                      # A curator's tour (tour_plan.h), beside site.toml; empty: the scene's stops.
///   keep_mib = 2048                      # Disk for pictures of the stops, for the farm's absence; 0: none are kept.
///   fetch_after_min = 10                 # They are fetched when nobody has steered for this long.
///
/// or, for a constant quality instead of the budget:
///
///   # site.toml
///   [picture]
///   samples = 1
///   jpeg_quality = 85
///   subsample_chroma = true
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/wire/tls.h"
#include "kiosk/tour/navigation/navigator.h"
#include "kiosk/tour/session/saved_position.h"

namespace cyclorama::tour {

struct PictureSettings {
  /// Time for each frame, from which the farm chooses the quality. 0: `samples`, `jpeg_quality` and `subsample_chroma`
  /// set the quality. Walking moves the picture at every refresh, whatever the frame rate, so fewer but better frames
  /// look better: docs/design/walking.md compares them.
  double frame_budget_ms = 150.0;
  int reference_samples = 1024;
  int samples = 1;
  int jpeg_quality = 85;
  bool subsample_chroma = true;
  /// Angle rendered beyond each side of the wall, for turns that no frame shows yet. 0: no guard band at all; otherwise
  /// walk_guard_rad() is added where a visitor can walk.
  double guard_rad = 0.0;
};

inline constexpr std::uint64_t kDefaultKeepBytes = std::uint64_t{2048} << 20;

struct TourSettings {
  std::vector<std::string> coordinators{"[::1]:7401"};
  std::string scene;
  std::string museum = "museum";
  std::optional<TlsFiles> tls{};  ///< Credentials for the connection to the farm.
  PictureSettings picture;
  NavigationSettings navigation;
  std::filesystem::path tour_folder{};           ///< Empty: the stops are the scene's own.
  std::uint64_t keep_bytes = kDefaultKeepBytes;  ///< Disk for kept pictures.
  Duration fetch_after = std::chrono::minutes(10);
  std::filesystem::path pictures_folder{};  ///< Folder of kept pictures; empty: none are kept. Not in the file.
  bool record = false;                      ///< Records the walk for Tour::take_recording(); not in the file.
  std::optional<SavedPosition> resume{};  ///< The visitor's position when the tour ended unexpectedly; not in the file.
};

/// Returns the guard band that a turn at full speed uses up within 0.2 s: the latency of one frame and the wait for the
/// next at 10 frames a second; 8 degrees at the default turn rate.
[[nodiscard]] double default_guard_rad(const WalkLimits& limits);

/// Returns the guard band for walking, which is added on all sides to the guard band for turning. It is the angle by
/// which the direction to nearby surfaces changes while a frame is shown. Each view is requested for the middle of that
/// time (prediction.h), so at full speed the eye moves for at most half a frame interval before or after it. A command
/// that arrives after the request also moves the eye, but the two effects do not add up: at full speed the visitor
/// cannot accelerate further. With the default limits, the result is 2.3 degrees.
[[nodiscard]] double walk_guard_rad(const WalkLimits& limits);

/// Returns the settings without a file.
[[nodiscard]] TourSettings default_tour_settings();
/// Errors: those of Config::read(); also limits under which the visitor would need more than a second to come to rest
/// after a lost tag.
Result<TourSettings> read_tour_settings(const std::filesystem::path& path);
/// `name` stands for the file in errors.
Result<TourSettings> parse_tour_settings(std::string_view text, std::string name);

}  // namespace cyclorama::tour
