// SPDX-License-Identifier: Apache-2.0
/// site.toml: a museum's own way, read strictly. Without a file everything has its default.
///
///   [farm]                                          [walk]
///   heads = ["[2001:db8::1]:7401"]                  forward_m_per_s = 1.0        neutral_distance_m = 1.0
///   scene = "grotto"      # empty: the first        turn_deg_per_s = 40          guide_after_s = 45   # 0: never
///   museum = "Hall 3"                               longest_turn_minutes = 0   # Of one visitor in a queue. 0: no
///   limit authority = "tls/authority.crt"     # All three, or none: not encrypted. certificate = "tls/certificate.crt"
///   # Files are sought in site.toml's folder. key = "tls/key.pem" [picture] frame_budget_ms = 50        # The farm
///   chooses the quality that fits, and refines at rest; reference_samples = 1024    # up to so many samples per pixel.
///   guard_deg = 8
///
/// or, for a picture of always the same quality, instead of the budget:
///
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
#include "kiosk/tour/session/kept_place.h"

namespace cyclorama {

struct PictureSettings {
  double frame_budget_ms = 50.0;  ///< 0: the next three say the quality.
  int reference_samples = 1024;
  int samples = 1;
  int jpeg_quality = 85;
  bool subsample_chroma = true;
  double guard_rad = 0.0;  ///< Rendered beyond each side of the wall, for turns that no frame has followed yet.
};

struct TourSettings {
  std::vector<std::string> heads{"[::1]:7401"};
  std::string scene;
  std::string museum = "museum";
  std::optional<TlsFiles> tls{};  ///< Towards the farm.
  PictureSettings picture;
  NavigationSettings navigation;
  bool record = false;                ///< Not of the file: keep the walk, to be taken.
  std::optional<KeptPlace> resume{};  ///< Not of the file: where the visitor was when the tour ended unasked.
};

/// The guard band that a turn at full speed eats up within 0.2 s: a frame's whole way and the next frame's wait at 10
/// frames a second; 8 degrees at the default turn rate.
[[nodiscard]] double default_guard_rad(const WalkLimits& limits);

/// No file: the defaults.
[[nodiscard]] TourSettings default_tour_settings();
/// Errors as Config::read(); limits with which a lost tag would take longer than a second to come to rest are refused.
Result<TourSettings> read_tour_settings(const std::filesystem::path& path);
/// `name` stands for the file in errors.
Result<TourSettings> parse_tour_settings(std::string_view text, std::string name);

}  // namespace cyclorama
