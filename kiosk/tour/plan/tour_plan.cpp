// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/tour_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/text.h"
#include "common/config/config.h"

namespace cyclorama::tour {
namespace {

using Eigen::Vector2d;

constexpr int kVersion = 1;
constexpr Range kMetres{-1e6, 1e6};
constexpr std::size_t kMaxLanguages = 32;

bool is_alphanumeric(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

/// True for the shape of a language tag (BCP 47): "en", "zh-Hant", "de-CH".
bool is_language(std::string_view tag) {
  constexpr std::size_t kMaxPart = 8;
  std::size_t part = 0;
  bool is_first = true;
  for (const char c : tag) {
    if (c == '-') {
      if (part < 2) return false;
      part = 0;
      is_first = false;
    } else if (!is_alphanumeric(c) || (is_first && c <= '9') || ++part > (is_first ? 3 : kMaxPart)) {
      return false;
    }
  }
  return part >= 2;
}

class PlanReader {
 public:
  PlanReader(ConfigTable root, const WalkableArea* area) : root_(std::move(root)), area_(area) {}

  TourPlan read() {
    root_.integer("version", {kVersion, kVersion});
    plan_.scene = root_.text("scene", "");
    read_languages();
    const bool keep = root_.flag("keep", true);
    plan_.title = read_texts(root_, "title", kMaxTitleBytes);
    read_limits(root_.table("limits"));
    if (root_.has("captions")) read_caption_style(root_.table("captions"));
    std::vector<ConfigTable> stops = root_.tables("stop");
    if (stops.empty()) root_.refuse("stop", "is missing; a tour needs at least one [[stop]]");
    if (stops.size() > kMaxPlannedStops)
      stops[kMaxPlannedStops].refuse("name",
                                     fmt::format("is of one stop too many; a tour has at most {}", kMaxPlannedStops));
    for (ConfigTable& stop : stops) read_stop(stop, keep);
    std::vector<ConfigTable> ways = root_.tables("way");
    if (ways.size() > kMaxPlannedWays)
      ways[kMaxPlannedWays].refuse("from",
                                   fmt::format("is of one way too many; a tour has at most {}", kMaxPlannedWays));
    for (ConfigTable& way : ways) read_way(way);
    return std::move(plan_);
  }

 private:
  void read_languages() {
    plan_.languages = root_.texts("languages");
    if (plan_.languages.empty()) {
      if (root_.has("languages")) root_.refuse("languages", "names no language; write [\"en\"], or another tag");
      plan_.languages = {"en"};
    }
    if (plan_.languages.size() > kMaxLanguages) {
      root_.refuse("languages",
                   fmt::format("has {} tags; at most {} are possible", plan_.languages.size(), kMaxLanguages));
      plan_.languages.resize(kMaxLanguages);
    }
    for (std::size_t i = 0; i < plan_.languages.size(); ++i) {
      const std::string& tag = plan_.languages[i];
      if (!is_language(tag))
        root_.refuse("languages",
                     fmt::format("has '{}', which is no language tag such as \"en\" or \"zh-Hant\"", printable(tag)));
      if (std::count(plan_.languages.begin(), plan_.languages.end(), tag) > 1)
        root_.refuse("languages", fmt::format("has '{}' twice", printable(tag)));
    }
  }

  /// Reads a table with a text for each language. Empty if the table is absent.
  Texts read_texts(ConfigTable& parent, std::string_view key, std::size_t max_bytes) {
    Texts texts;
    if (!parent.has(key)) return texts;
    ConfigTable table = parent.table(key);
    for (const std::string& language : plan_.languages) {
      if (language != plan_.languages.front() && !table.has(language)) continue;
      std::string text = table.text(language);
      if (text.size() > max_bytes)
        table.refuse(language, fmt::format("has {} bytes; at most {} are shown", text.size(), max_bytes));
      if (printable(text, max_bytes) != text)
        table.refuse(language, "has control characters; write the text in one line");
      texts.emplace(language, std::move(text));
    }
    return texts;
  }

  void read_limits(ConfigTable limits) {
    if (limits.has("walk_m_per_s")) plan_.walk_m_per_s = limits.number("walk_m_per_s", {0.0, 2.0});
    if (limits.has("turn_deg_per_s"))
      plan_.turn_rad_per_s = kRadiansPerDegree * limits.number("turn_deg_per_s", {0.0, 180.0});
    if (limits.has("eye_height_m")) plan_.eye_height_m = limits.number("eye_height_m", {0.5, 2.5});
    plan_.reduced_motion = limits.flag("reduced_motion", false);
  }

  void read_caption_style(ConfigTable table) {
    CaptionStyle& style = plan_.captions.emplace();
    style.shown = table.texts("show", std::vector{plan_.languages.front()});
    for (const std::string& tag : style.shown) {
      if (std::ranges::find(plan_.languages, tag) == plan_.languages.end())
        table.refuse("show", fmt::format("has '{}', which is not among the tour's languages", printable(tag)));
    }
    if (style.shown.size() > kMaxShownLanguages)
      table.refuse("show", fmt::format("has {} languages; at most {} are written at once", style.shown.size(),
                                       kMaxShownLanguages));
    style.letters_rad = kRadiansPerDegree / 60.0 * table.number("letters_arcmin", {20.0, 300.0}, 40.0);
    style.width_rad = kRadiansPerDegree * table.number("width_deg", {10.0, 90.0}, 40.0);
    style.azimuth_rad = kRadiansPerDegree * table.number("azimuth_deg", {-180.0, 180.0}, 0.0);
    if (table.has("elevation_deg"))
      style.elevation_rad = kRadiansPerDegree * table.number("elevation_deg", {-60.0, 85.0});
  }

  /// Reads a stop's table with the name of a file for each language.
  Texts read_caption_files(ConfigTable& stop) {
    Texts files;
    if (!stop.has("captions")) return files;
    ConfigTable table = stop.table("captions");
    if (!plan_.captions) stop.refuse("captions", "are written nowhere; add a table [captions] above the stops");
    for (const std::string& language : plan_.languages) {
      if (!table.has(language)) continue;
      std::string file = table.text(language);
      // A name without a folder, so that a tour never reads what is not its own.
      if (file.empty() || file.front() == '.' || file.find('/') != file.npos || printable(file, file.size()) != file)
        table.refuse(language, fmt::format("is '{}'; name a file beside tour.toml", printable(file)));
      files.emplace(language, std::move(file));
    }
    return files;
  }

  void check_place(ConfigTable& table, std::string_view key, const Vector2d& position) {
    if (area_ == nullptr || area_->allows(position)) return;
    const Vector2d allowed = area_->nearest_allowed(position);
    table.refuse(key, fmt::format("has ({}, {}), where nobody can stand; the nearest place is [{:.2f}, {:.2f}]",
                                  position.x(), position.y(), allowed.x(), allowed.y()));
  }

  void read_stop(ConfigTable& table, bool keep) {
    PlannedStop planned;
    GuideStop& stop = planned.stop;
    stop.name = table.text("name");
    if (!stop.name.empty() && !is_stop_name(stop.name))
      table.refuse("name",
                   fmt::format("is '{}'; a name has 1 to 40 letters of a to z, digits and '-'", printable(stop.name)));
    if (index_of(stop.name))
      table.refuse("name", fmt::format("'{}' is another stop's; give each its own", printable(stop.name)));
    const std::vector<double> position = table.numbers("position_m", 2, kMetres);
    if (position.size() == 2) stop.position_m = {position[0], position[1]};
    check_place(table, "position_m", stop.position_m);
    stop.heading_rad = kRadiansPerDegree * table.number("heading_deg", {-360.0, 360.0});
    const double stay_s = table.number("stay_s", {1.0, 3600.0}, to_seconds(stop.stay));
    stop.stay = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(stay_s));
    planned.keep = table.flag("keep", true) && keep;
    planned.title = read_texts(table, "title", kMaxTitleBytes);
    planned.text = read_texts(table, "text", kMaxTextBytes);
    planned.caption_files = read_caption_files(table);
    for (ConfigTable& lamps : table.tables("lamps")) {
      const std::string group = lamps.text("group");
      const auto level = static_cast<float>(lamps.number("level", {0.0, 4.0}));
      if (!planned.lamps.emplace(group, level).second)
        lamps.refuse("group", fmt::format("'{}' has two levels at this stop; keep one", printable(group)));
    }
    stop.title = planned.title.empty() ? stop.name : planned.title[plan_.languages.front()];
    plan_.stops.push_back(std::move(planned));
  }

  void read_way(ConfigTable& table) {
    GuideWay way;
    way.from = end_of(table, "from");
    way.to = end_of(table, "to");
    if (way.from == way.to) table.refuse("to", "is the stop where the way begins");
    way.is_cut = table.choice("by", {"walk", "cut"}, "walk") == "cut";
    for (const std::vector<double>& point : table.points("through_m", 2, kMetres)) {
      way.through.emplace_back(point[0], point[1]);
      check_place(table, "through_m", way.through.back());
    }
    if (way.through.size() > kMaxThrough)
      table.refuse("through_m",
                   fmt::format("has {} positions; at most {} are possible", way.through.size(), kMaxThrough));
    if (way.is_cut && !way.through.empty())
      table.refuse("through_m", "belongs to a walk; leave it out or set by = \"walk\"");
    plan_.ways.push_back(std::move(way));
  }

  [[nodiscard]] std::optional<std::size_t> index_of(const std::string& name) const {
    const auto stop = std::ranges::find(plan_.stops, name, [](const PlannedStop& s) { return s.stop.name; });
    if (stop == plan_.stops.end()) return std::nullopt;
    return static_cast<std::size_t>(stop - plan_.stops.begin());
  }
  std::size_t end_of(ConfigTable& way, const char* key) {
    const std::string name = way.text(key);
    const std::optional<std::size_t> index = index_of(name);
    if (!index) way.refuse(key, fmt::format("names no stop '{}' of this tour", printable(name)));
    return index.value_or(0);
  }

  ConfigTable root_;
  const WalkableArea* area_;
  TourPlan plan_;
};

/// Returns the tour's limit as a share of the museum's.
double share_of(const std::optional<double>& wanted, double museum) {
  return wanted && museum > 0.0 ? std::min(1.0, *wanted / museum) : 1.0;
}

}  // namespace

bool is_stop_name(std::string_view name) {
  constexpr std::size_t kMaxNameBytes = 40;
  const auto is_allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  return !name.empty() && name.size() <= kMaxNameBytes && std::all_of(name.begin(), name.end(), is_allowed);
}

Result<TourPlan> parse_tour_plan(std::string_view text, std::string name, const WalkableArea* area) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  TourPlan plan = PlanReader(config.root(), area).read();
  TRY(config.finish());
  return plan;
}

Site with_plan(Site site, const TourPlan& plan, const WalkLimits& museum) {
  site.stops.clear();
  for (const PlannedStop& planned : plan.stops) site.stops.push_back(planned.stop);
  site.ways = plan.ways;
  site.pace = share_of(plan.walk_m_per_s, std::max(museum.forward_m_per_s, museum.sideways_m_per_s));
  site.turn_pace = share_of(plan.turn_rad_per_s, museum.turn_rad_per_s);
  site.reduced_motion = plan.reduced_motion;
  return site;
}

}  // namespace cyclorama::tour
