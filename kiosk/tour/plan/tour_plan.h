// SPDX-License-Identifier: Apache-2.0
/// A curator's tour, tour.toml, read strictly:
///
///   # tour.toml
///   version = 1
///   scene = "grotto"                  # Left out: whichever scene the museum visits.
///   languages = ["en", "de"]          # BCP 47. The first is shown where nobody chose another.
///   keep = true                       # false: no picture of any stop is kept for the farm's absence.
///   [title]
///   en = "Cave 158"                   # The first language must be there, others may.
///   de = "Höhle 158"
///   [limits]                          # Never above those of site.toml.
///   walk_m_per_s = 0.6
///   turn_deg_per_s = 25
///   eye_height_m = 1.2                # Of a seated visitor or a child. Left out: the scene's.
///   reduced_motion = false            # true: soft cuts between stops instead of walks.
///   [captions]                        # Left out: nothing is written on the wall.
///   show = ["en"]                     # At most two at once. Left out: the first language. Empty: none at first.
///   letters_arcmin = 40               # Height of a capital letter, from the sweet spot.
///   width_deg = 40                    # Of the lines, at most.
///   azimuth_deg = 0                   # Of their middle, to the right of the wall's.
///   elevation_deg = 12                # Left out: at the wall's upper edge.
///   [[stop]]
///   name = "entrance"
///   position_m = [0.0, 2.5]           # (x, z) in the scene, in the walkable area.
///   heading_deg = 0
///   [[stop]]
///   name = "buddha"
///   position_m = [0.5, -2.0]
///   heading_deg = -30
///   stay_s = 20                       # How long the guide stays; 8 when left out.
///   keep = true                       # false: no picture of this stop is kept.
///   [stop.title]
///   en = "The reclining Buddha"
///   [stop.text]
///   en = "Clay on a sandstone core."
///   [stop.captions]                   # Captions with times, from the arrival at the stop (webvtt.h).
///   en = "buddha.en.vtt"              # Beside tour.toml.
///   [[stop.lamps]]                    # Groups of lamps of the scene, which fade to a level; others stay.
///   group = "daylight"
///   level = 0.2                       # 0 to 4; 1: as the scene describes them.
///   [[way]]                           # Left out: on foot by the shortest way.
///   from = "entrance"
///   to = "buddha"                     # And back.
///   by = "walk"                       # Or "cut".
///   through_m = [[0.0, 1.0]]          # Positions that the walk passes.
#pragma once

#include <Eigen/Core>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "kiosk/tour/navigation/guide.h"
#include "kiosk/tour/plan/webvtt.h"

namespace cyclorama::tour {

/// A text in several languages, by their tags.
using Texts = std::map<std::string, std::string>;

struct PlannedStop {
  GuideStop stop;  ///< `title` is in the tour's first language.
  Texts title;
  Texts text;
  bool keep = true;                    ///< False also where the whole tour must not be kept.
  std::map<std::string, float> lamps;  ///< Levels of the scene's groups of lamps, by name.
  Texts caption_files{};               ///< Names of WebVTT files in the tour's folder, by language.
  /// Content of these files; empty until read_captions() in tour_folder.h has read them.
  std::map<std::string, std::vector<Cue>> captions{};
};

/// The way in which a tour writes on the wall. Angles are seen from the sweet spot.
struct CaptionStyle {
  std::vector<std::string> shown;  ///< Languages at first; at most kMaxShownLanguages.
  double letters_rad = 0.0;        ///< Height of a capital letter.
  double width_rad = 0.0;          ///< Width of the lines, at most.
  double azimuth_rad = 0.0;        ///< Direction of the middle.
  std::optional<double> elevation_rad;
};

/// A value; `ways` and the stops' order are those of the file.
struct TourPlan {
  std::string scene;  ///< Empty: any.
  std::vector<std::string> languages;
  Texts title;
  std::optional<double> walk_m_per_s;
  std::optional<double> turn_rad_per_s;
  std::optional<double> eye_height_m;
  bool reduced_motion = false;
  std::optional<CaptionStyle> captions;  ///< Empty: nothing is written on the wall.
  std::vector<PlannedStop> stops;
  std::vector<GuideWay> ways;
};

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
inline constexpr std::size_t kMaxPlannedStops = 256;
inline constexpr std::size_t kMaxPlannedWays = 1024;
inline constexpr std::size_t kMaxThrough = 64;
inline constexpr std::size_t kMaxTitleBytes = 200;
inline constexpr std::size_t kMaxTextBytes = 4000;
inline constexpr std::size_t kMaxShownLanguages = 2;

/// `name` stands for the file in errors. With an `area`, all positions must be allowed in it. Errors: kBadData with
/// file, line and remedy; for a stop outside the area with the nearest position that is allowed.
Result<TourPlan> parse_tour_plan(std::string_view text, std::string name, const WalkableArea* area = nullptr);

/// Returns the site with the plan's stops, ways and limits in place of the scene's. `museum` has the museum's limits.
/// Precondition: the plan was parsed with site.area.
[[nodiscard]] Site with_plan(Site site, const TourPlan& plan, const WalkLimits& museum);

/// True for a stop's name: 1 to 40 letters of a to z, digits and '-'.
[[nodiscard]] bool is_stop_name(std::string_view name);

}  // namespace cyclorama::tour
