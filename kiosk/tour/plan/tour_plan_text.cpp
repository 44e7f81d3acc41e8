// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/tour_plan_text.h"

#include <fmt/format.h>

#include <iterator>

#include "common/config/toml_text.h"

namespace cyclorama::tour {
namespace {

template <typename... Values>
void add(std::string* text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(*text), format, std::forward<Values>(values)...);
}

void add_texts(std::string* text, std::string_view table, const Texts& texts) {
  if (texts.empty()) return;
  add(text, "[{}]\n", table);
  for (const auto& [language, words] : texts) add(text, "{} = {}\n", language, toml_string(words));
}

std::string list_of(const std::vector<std::string>& words) {
  std::string text = "[";
  for (const std::string& word : words) add(&text, "{}{}", text.size() == 1 ? "" : ", ", toml_string(word));
  return text + "]";
}

void add_style(std::string* text, const CaptionStyle& style) {
  add(text, "[captions]\nshow = {}\nletters_arcmin = {:.9g}\nwidth_deg = {:.9g}\nazimuth_deg = {:.9g}\n",
      list_of(style.shown), 60.0 * style.letters_rad / kRadiansPerDegree, style.width_rad / kRadiansPerDegree,
      style.azimuth_rad / kRadiansPerDegree);
  if (style.elevation_rad) add(text, "elevation_deg = {:.9g}\n", *style.elevation_rad / kRadiansPerDegree);
}

}  // namespace

std::string to_toml(const PlannedStop& planned) {
  const GuideStop& stop = planned.stop;
  std::string text =
      fmt::format("[[stop]]\nname = {}\nposition_m = [{}, {}]\nheading_deg = {}\n", toml_string(stop.name),
                  stop.position_m.x(), stop.position_m.y(), stop.heading_rad / kRadiansPerDegree);
  if (stop.stay != GuideStop{}.stay) add(&text, "stay_s = {}\n", to_seconds(stop.stay));
  if (!planned.keep) add(&text, "keep = false\n");
  add_texts(&text, "stop.title", planned.title);
  add_texts(&text, "stop.text", planned.text);
  add_texts(&text, "stop.captions", planned.caption_files);
  for (const auto& [group, level] : planned.lamps)
    add(&text, "[[stop.lamps]]\ngroup = {}\nlevel = {}\n", toml_string(group), level);
  return text;
}

std::string to_toml(const TourPlan& plan) {
  std::string text = "version = 1\n";
  if (!plan.scene.empty()) add(&text, "scene = {}\n", toml_string(plan.scene));
  add(&text, "languages = {}\n", list_of(plan.languages));
  add_texts(&text, "title", plan.title);
  add(&text, "[limits]\n");
  if (plan.walk_m_per_s) add(&text, "walk_m_per_s = {}\n", *plan.walk_m_per_s);
  if (plan.turn_rad_per_s) add(&text, "turn_deg_per_s = {}\n", *plan.turn_rad_per_s / kRadiansPerDegree);
  if (plan.eye_height_m) add(&text, "eye_height_m = {}\n", *plan.eye_height_m);
  if (plan.reduced_motion) add(&text, "reduced_motion = true\n");
  if (plan.captions) add_style(&text, *plan.captions);
  for (const PlannedStop& stop : plan.stops) text += "\n" + to_toml(stop);
  for (const GuideWay& way : plan.ways) {
    add(&text, "\n[[way]]\nfrom = {}\nto = {}\n", toml_string(plan.stops[way.from].stop.name),
        toml_string(plan.stops[way.to].stop.name));
    if (way.is_cut) add(&text, "by = \"cut\"\n");
    if (way.through.empty()) continue;
    add(&text, "through_m = [");
    for (std::size_t i = 0; i < way.through.size(); ++i)
      add(&text, "{}[{}, {}]", i == 0 ? "" : ", ", way.through[i].x(), way.through[i].y());
    add(&text, "]\n");
  }
  return text;
}

}  // namespace cyclorama::tour
