// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <sstream>

#include "appliance/calibrator/calibrator_settings.h"
#include "appliance/display/display_settings.h"
#include "appliance/tracker/tracker_settings.h"
#include "common/base/clock.h"
#include "common/base/file.h"
#include "common/config/config.h"
#include "common/config/safe_toml.h"
#include "common/network/network_settings.h"
#include "common/room/installation.h"
#include "common/wand/wand.h"
#include "drivers/devices/make_camera.h"
#include "drivers/devices/make_turntable.h"
#include "drivers/simulated/camera/simulation.h"
#include "kiosk/care/care_settings.h"
#include "kiosk/provision/operator_settings.h"
#include "kiosk/tour/plan/tour_plan.h"
#include "kiosk/tour/session/saved_position.h"
#include "kiosk/tour/session/tour_settings.h"
#include "kiosk/update/update_settings.h"
#include "tests/unit/settings/settings_examples.h"
#include "tests/unit/settings/settings_parsers.h"

namespace cyclorama {
namespace {

namespace fs = std::filesystem;

Parser one_after_another(std::vector<Parser> parsers) {
  return [parsers = std::move(parsers)](const std::string& text, const std::string& name) -> Status {
    for (const Parser& parse : parsers) TRY(parse(text, name));
    return Done{};
  };
}

/// Several programs read site.toml; each of them reads its own tables.
Parser site_parser() {
  return one_after_another({parser(tour::parse_tour_settings), parser(display::parse_display_settings),
                            parser(update::parse_update_settings), parser(parse_network_settings)});
}

/// A parser of lines that describe a device. A device that is not plugged in is not a mistake.
template <typename Make>
Parser device_parser(Make make) {
  return [make](const std::string& text, const std::string&) -> Status {
    for (std::size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1) {
      std::string line = text.substr(begin, text.find('\n', begin) - begin);
      line = std::regex_replace(line, std::regex(R"(^\s+|\s+(#.*)?$|^#.*)"), "");
      if (line.empty()) continue;
      const Status made = make(line);
      if (!made && made.error().code() == ErrorCode::kInvalidArgument) return made;
    }
    return Done{};
  };
}

const std::map<std::string, Parser>& parsers() {
  static const SteadyClock clock;
  static const std::map<std::string, Parser> museum{
      {"benchmarks.toml", parser([](const auto& text, const auto& name) { return Config::parse(text, name); })},
      {"calibrator.toml", parser(calibrator::CalibratorSettings::parse)},
      {"care.toml", parser(care::parse_care_settings)},
      {"hand.toml", parser(simulated::Simulation::parse)},
      {"installation.toml", parser([](const auto& text, const auto& name) { return parse_installation(text, name); })},
      {"operator.toml", parser(provision::parse_operator_settings)},
      {"place.toml", parser(tour::parse_saved_position)},
      {"site.toml", site_parser()},
      {"tour.toml", parser([](const auto& text, const auto& name) { return tour::parse_tour_plan(text, name); })},
      {"tracker.toml", parser(tracker::TrackerSettings::parse)},
      {"wand.toml", parser(parse_wand)},
      {"camera", device_parser([](const std::string& line) -> Status {
         auto camera = devices::make_camera(line, clock);
         if (!camera) return camera.error();
         return Done{};
       })},
      {"turntable", device_parser([](const std::string& line) { return devices::check_turntable(line); })},
  };
  static const std::map<std::string, Parser> all = [] {
    std::map<std::string, Parser> both = farm_parsers();
    both.insert(museum.begin(), museum.end());
    return both;
  }();
  return all;
}

/// Returns the settings that complete a part of this file.
Result<std::string> rest_of(const std::string& file_name) {
  if (file_name == "farm.toml")
    return std::string("museums = \"[::1]:1\"\nnodes = \"[::1]:2\"\n[[scene]]\nname = \"a\"\npath = \"/srv/a\"\n");
  if (file_name == "scene.toml") return std::string("title = \"a\"\n[[geometry]]\nfile = \"walls.ply\"\n");
  if (file_name == "installation.toml") {
    const char* const source = std::getenv("CYCLORAMA_SOURCE");  // NOLINT(concurrency-mt-unsafe): nobody sets it.
    return read_text_file(fs::path(source != nullptr ? source : ".") / "demo/installation.toml", 1 << 20);
  }
  return std::string();
}

/// Merges `part` into `whole`: tables key by key, [[tables]] by position; other values are replaced.
void merge(const toml::table& part, toml::table* whole) {
  for (const auto& [key, value] : part) {
    toml::node* const there = whole->get(key.str());
    if (there != nullptr && there->is_table() && value.is_table()) {
      merge(*value.as_table(), there->as_table());
    } else if (there != nullptr && there->is_array_of_tables() && value.is_array_of_tables()) {
      toml::array& rows = *there->as_array();
      for (std::size_t i = 0; i < value.as_array()->size(); ++i) {
        const toml::table& row = *value.as_array()->get(i)->as_table();
        if (i < rows.size()) {
          merge(row, rows.get(i)->as_table());
        } else {
          rows.push_back(row);
        }
      }
    } else {
      whole->insert_or_assign(key.str(), value);
    }
  }
}

Result<std::string> completed(const SettingsExample& example) {
  TRY_ASSIGN(const std::string rest, rest_of(example.file_name));
  const toml::parse_result part = toml::parse(example.text);
  toml::parse_result whole = toml::parse(rest);
  if (!part) return Error(ErrorCode::kBadData, std::string(part.error().description()));
  if (!whole) return Error(ErrorCode::kBadData, std::string(whole.error().description()));
  merge(part.table(), &whole.table());
  std::ostringstream text;
  text << toml::toml_formatter(whole.table());
  return text.str();
}

Status parse_example(const SettingsExample& example, const Parser& parse, const std::string& path) {
  if (!example.is_in_part) {
    // Lines are counted as in the document.
    return parse(std::string(static_cast<std::size_t>(example.line - 1), '\n') + example.text, path);
  }
  TRY_ASSIGN(const std::string whole, completed(example));
  return parse(whole, path);
}

/// Returns the example once for each alternative in its comments (a key, or a table with its keys), with it added.
std::vector<SettingsExample> alternatives(const SettingsExample& example) {
  static const std::regex kShown(
      R"re(# ?(\[\[?[a-z_.]+\]\]?\s*(#.*)?|[a-z_0-9]+ = ("[^"]*"|\[.*\]|-?[0-9.]+|true|false)\s*(#.*)?))re");
  std::vector<std::string> lines;
  std::istringstream text(example.text);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  std::vector<SettingsExample> all;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!std::regex_match(lines[i], kShown)) continue;
    const auto shown = [&](std::size_t k) { return lines[k].substr(lines[k].find_first_not_of("# ")); };
    std::vector<std::string> changed = lines;
    changed[i] = shown(i);
    const bool is_table = changed[i].starts_with('[');
    while (is_table && i + 1 < lines.size() && std::regex_match(lines[i + 1], kShown) &&
           !shown(i + 1).starts_with('[')) {
      ++i;
      changed[i] = shown(i);
    }
    SettingsExample alternative = example;
    alternative.text.clear();
    for (const std::string& line : changed) alternative.text += line + "\n";
    all.push_back(std::move(alternative));
  }
  return all;
}

bool names_no_setting(const std::string& error) {
  return error.find("is not a setting") != std::string::npos || error.find("is called '") != std::string::npos;
}

}  // namespace

std::vector<std::string> mistakes_of(const SettingsExample& example, const std::string& path) {
  const std::string where = fmt::format("{}:{}", path, example.line);
  const auto parse = parsers().find(example.file_name);
  if (parse == parsers().end()) {
    return {
        fmt::format("{}: settings of an unknown file; write '# site.toml' (or another file) in the first line, or add"
                    " its parser to tests/unit/settings/settings_parsers.cpp",
                    where)};
  }
  std::vector<std::string> mistakes;
  const Status read = parse_example(example, parse->second, path);
  if (!read) return {fmt::format("{} ({}): {}", where, example.file_name, read.error().message())};
  for (const SettingsExample& alternative : alternatives(example)) {
    const Status other = parse_example(alternative, parse->second, path);
    // An alternative may contradict the rest of the example, but it must name existing settings.
    if (!other && names_no_setting(other.error().message())) {
      mistakes.push_back(fmt::format("{} ({}), in a comment: {}", where, example.file_name, other.error().message()));
    }
  }
  return mistakes;
}

}  // namespace cyclorama
