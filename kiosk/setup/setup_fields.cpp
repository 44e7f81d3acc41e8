// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/setup_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "common/base/address.h"
#include "common/base/text.h"
#include "common/room/installation.h"

namespace cyclorama::setup {
namespace {

constexpr int kMaxProjectors = 8;
constexpr std::size_t kMaxName = 60;

/// A measured length or angle, with its limits, and the words of its field.
struct Measure {
  const char* name;
  double RoomPlan::*value;
  double min;
  double max;
  const char* unit;
  enum { kBoth, kRound, kFlat } wall;
};
constexpr std::array kMeasures{
    Measure{"radius_m", &RoomPlan::radius_m, 0.5, 50.0, "m", Measure::kRound},
    Measure{"arc_deg", &RoomPlan::arc_deg, 5.0, 355.0, "degrees", Measure::kRound},
    Measure{"width_m", &RoomPlan::width_m, 0.3, 100.0, "m", Measure::kFlat},
    Measure{"distance_m", &RoomPlan::distance_m, 0.3, 100.0, "m", Measure::kFlat},
    Measure{"bottom_m", &RoomPlan::bottom_m, 0.0, 20.0, "m", Measure::kBoth},
    Measure{"top_m", &RoomPlan::top_m, 0.2, 30.0, "m", Measure::kBoth},
    Measure{"eye_m", &RoomPlan::eye_m, 0.5, 3.0, "m", Measure::kBoth},
    Measure{"lens_height_m", &RoomPlan::lens_height_m, 0.0, 30.0, "m", Measure::kBoth},
    Measure{"lens_distance_m", &RoomPlan::lens_distance_m, 0.3, 100.0, "m", Measure::kBoth},
    Measure{"picture_width_m", &RoomPlan::picture_width_m, 0.2, 100.0, "m", Measure::kBoth},
};

/// Parses a number as people write it in any of the page's languages: "3.2" or "3,2".
std::optional<double> number_in(const Fields& fields, const std::string& name) {
  std::string text = text_in(fields, name);
  std::ranges::replace(text, ',', '.');
  const auto number = parse_double(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

int count_of(const Fields& projectors) {
  const auto count = parse_integer(text_in(projectors, "count"));
  return count && *count >= 1 && *count <= kMaxProjectors ? static_cast<int>(*count) : 0;
}

std::string of_projector(int number, const char* what) { return fmt::format("{}.{}", number, what); }

std::vector<FieldProblem> name_problems(const Fields& fields) {
  const std::string name = text_in(fields, "museum");
  if (name.empty())
    return {{"museum", "Give this installation a name, such as Hall 3; the wall and the farm show it."}};
  if (name.size() > kMaxName || name.find_first_of("\"\\") != std::string::npos || printable(name, kMaxName) != name)
    return {{"museum", "Write at most 60 letters, without quotation marks and backslashes."}};
  return {};
}

std::vector<FieldProblem> network_problems(const Fields& fields, const SetupFacts& facts) {
  std::vector<FieldProblem> problems;
  const std::string vlan = text_in(fields, "vlan");
  if (!vlan.empty() && !parse_integer(vlan))
    problems.push_back({"vlan", fmt::format("'{}' is no number; a VLAN has one from 1 to 4094.", printable(vlan))});
  for (const NetworkMistake& mistake : mistakes_of(network_of(fields))) {
    problems.push_back({mistake.key, "This " + mistake.sentence + "."});
  }
  const std::string cable = text_in(fields, "interface");
  if (!cable.empty() && problems.empty() && std::ranges::find(facts.cables, cable) == facts.cables.end())
    problems.push_back({"interface", fmt::format("This computer has no network socket '{}'.", printable(cable))});
  return problems;
}

std::vector<FieldProblem> projector_problems(const Fields& fields, const SetupFacts& facts) {
  const int count = count_of(fields);
  if (count == 0)
    return {{"count", fmt::format("Choose how many projectors light the wall, 1 to {}.", kMaxProjectors)}};
  std::vector<FieldProblem> problems;
  std::set<std::string> names;
  std::set<std::string> connectors;
  for (int i = 1; i <= count; ++i) {
    const std::string name = text_in(fields, of_projector(i, "name"));
    const bool is_plain = !name.empty() && name.size() <= 40 && std::ranges::all_of(name, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    });
    if (!is_plain)
      problems.push_back({of_projector(i, "name"), "Use small letters, digits and '-', such as left or middle-2."});
    else if (!names.insert(name).second)
      problems.push_back({of_projector(i, "name"), fmt::format("Two projectors are called {}; rename one.", name)});
    const std::string connector = text_in(fields, of_projector(i, "connector"));
    if (connector.empty()) {
      problems.push_back({of_projector(i, "connector"), "Choose its socket; let it blink if you do not know which."});
    } else if (!connectors.insert(connector).second) {
      problems.push_back(
          {of_projector(i, "connector"), fmt::format("{} has another projector already.", printable(connector))});
    } else if (std::ranges::find(facts.plugged, connector, &PluggedProjector::connector) == facts.plugged.end()) {
      problems.push_back({of_projector(i, "connector"),
                          fmt::format("Nothing is plugged into {} now; switch the projector on, or look at its cable.",
                                      printable(connector))});
    }
    const std::string turn = text_in(fields, of_projector(i, "turn_deg"));
    if (!turn.empty() && turn != "0" && turn != "90" && turn != "180" && turn != "270")
      problems.push_back({of_projector(i, "turn_deg"), "Choose 0, 90, 180 or 270 degrees."});
    const std::string pjlink = text_in(fields, of_projector(i, "pjlink"));
    if (!pjlink.empty() && (pjlink.find(' ') != std::string::npos || !parse_projector_address(pjlink)))
      problems.push_back(
          {of_projector(i, "pjlink"), "Write its network address, such as 192.0.2.11, or leave it out."});
  }
  return problems;
}

std::vector<FieldProblem> wall_problems(const Fields& projectors, const Fields& fields, const SetupFacts& facts) {
  std::vector<FieldProblem> problems;
  const std::string shape = text_in(fields, "shape");
  if (shape != "round" && shape != "flat") return {{"shape", "Choose whether the wall is round or flat."}};
  for (const Measure& measure : kMeasures) {
    if (measure.wall == (shape == "round" ? Measure::kFlat : Measure::kRound)) continue;
    const auto value = number_in(fields, measure.name);
    if (!value || *value < measure.min || *value > measure.max) {
      problems.push_back(
          {measure.name, fmt::format("Write a number from {:g} to {:g} {}.", measure.min, measure.max, measure.unit)});
    }
  }
  if (!problems.empty()) return problems;
  const RoomPlan plan = plan_of(projectors, fields, facts);
  if (plan.top_m <= plan.bottom_m) return {{"top_m", "The top of the wall must be above its bottom."}};
  if (plan.projectors.empty()) return {{"", "Choose the projectors first; then the wall can be checked against them."}};
  const auto reach = reach_of(plan);
  if (!reach) return {{"", fmt::format("This room does not work: {}.", reach.error().message())}};
  return {};
}

std::vector<FieldProblem> camera_problems(const Fields& fields, const SetupFacts& facts) {
  const std::string port = text_in(fields, "calibration");
  if (port.empty()) return {{"calibration", "Choose the camera that stands on the turntable."}};
  if (std::ranges::find(facts.cameras, port) == facts.cameras.end())
    return {{"calibration", fmt::format("No camera is at {} now; plug it in.", printable(port))}};
  return {};
}

std::vector<FieldProblem> farm_problems(const Fields& fields, bool is_untouched) {
  const std::vector<std::string> coordinators = list_in(text_in(fields, "coordinators"));
  // The image's own settings name this computer, which stands for no farm.
  if (coordinators.empty() || (is_untouched && std::ranges::all_of(coordinators, is_loopback)))
    return {{"coordinators", "Write the farm's address, such as farm.example.org:7401; the farm's operator has it."}};
  for (const std::string& one : coordinators) {
    const auto address = parse_address(one);
    if (address) continue;
    return {{"coordinators", fmt::format("'{}' is no address with a port; write one such as farm.example.org:7401 or "
                                         "[2001:db8::1]:7401.",
                                         printable(one))}};
  }
  return {};
}

std::vector<FieldProblem> tour_problems(const Fields& fields) {
  const std::string scene = text_in(fields, "scene");
  const bool is_plain = scene.size() <= kMaxName && std::ranges::all_of(scene, [](char c) {
                          return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
                        });
  if (is_plain) return {};
  return {{"scene", "A tour's name has letters, digits, '-', '_' and '.'; leave it out for the farm's first."}};
}

const Fields& fields_in(const std::map<std::string, StepDraft>& all, const char* step) {
  static const Fields kNone;
  const auto found = all.find(step);
  return found == all.end() ? kNone : found->second.fields;
}

}  // namespace

const std::vector<std::string>& field_steps() {
  static const std::vector<std::string> kSteps{kNameStep,    kNetworkStep, kProjectorsStep, kWallStep,
                                               kCamerasStep, kFarmStep,    kTourStep};
  return kSteps;
}

std::string text_in(const Fields& fields, const std::string& name) {
  const auto found = fields.find(name);
  return found == fields.end() ? "" : found->second;
}

std::vector<std::string> list_in(const std::string& text) {
  std::vector<std::string> list;
  std::string one;
  for (const char c : text + " ") {
    if (c != ',' && c != ' ' && c != ';' && c != '\n' && c != '\t') {
      one += c;
    } else if (!one.empty()) {
      list.push_back(std::exchange(one, ""));
    }
  }
  return list;
}

std::vector<FieldProblem> problems_of(const std::string& step, const std::map<std::string, StepDraft>& all,
                                      const SetupFacts& facts) {
  const Fields& fields = fields_in(all, step.c_str());
  if (step == kNameStep) return name_problems(fields);
  if (step == kNetworkStep) return network_problems(fields, facts);
  if (step == kProjectorsStep) return projector_problems(fields, facts);
  if (step == kWallStep) return wall_problems(fields_in(all, kProjectorsStep), fields, facts);
  if (step == kCamerasStep) return camera_problems(fields, facts);
  if (step == kFarmStep) return farm_problems(fields, !all.contains(step) || all.at(step).revision == 0);
  if (step == kTourStep) return tour_problems(fields);
  return {{"", "There is no such step."}};
}

NetworkSettings network_of(const Fields& fields) {
  NetworkSettings network;
  const auto take = [&](const char* name, std::string* value) {
    if (fields.contains(name)) *value = text_in(fields, name);
  };
  take("interface", &network.interface);
  const auto vlan = parse_integer(text_in(fields, "vlan"));
  network.vlan = vlan ? static_cast<int>(std::clamp(*vlan, -1LL, 9999LL)) : 0;
  take("ipv4", &network.ipv4);
  take("ipv6", &network.ipv6);
  // The page hides these fields for other ways, and keeps what was typed.
  if (network.ipv4 == "static") {
    take("ipv4_address", &network.ipv4_address);
    take("ipv4_gateway", &network.ipv4_gateway);
  }
  if (network.ipv6 == "static") {
    take("ipv6_address", &network.ipv6_address);
    take("ipv6_gateway", &network.ipv6_gateway);
  }
  network.dns = list_in(text_in(fields, "dns"));
  network.time_servers = list_in(text_in(fields, "time_servers"));
  take("proxy", &network.proxy);
  PortLogin& login = network.login;
  take("login.method", &login.method);
  if (login.method.empty()) return network;
  take("login.identity", &login.identity);
  take("login.authority", &login.authority);
  take("login.server_name", &login.server_name);
  if (login.method == "tls") {
    take("login.certificate", &login.certificate);
    take("login.key", &login.key);
  } else {
    take("login.password_file", &login.password_file);
  }
  return network;
}

Fields fields_of(const NetworkSettings& network) {
  const auto joined = [](const std::vector<std::string>& list) {
    std::string text;
    for (const std::string& one : list) text += (text.empty() ? "" : ", ") + one;
    return text;
  };
  const PortLogin& login = network.login;
  return {{"interface", network.interface},
          {"vlan", network.vlan == 0 ? "" : std::to_string(network.vlan)},
          {"ipv4", network.ipv4},
          {"ipv4_address", network.ipv4_address},
          {"ipv4_gateway", network.ipv4_gateway},
          {"ipv6", network.ipv6},
          {"ipv6_address", network.ipv6_address},
          {"ipv6_gateway", network.ipv6_gateway},
          {"dns", joined(network.dns)},
          {"time_servers", joined(network.time_servers)},
          {"proxy", network.proxy},
          {"login.method", login.method},
          {"login.identity", login.identity},
          {"login.password_file", login.password_file},
          {"login.authority", login.authority},
          {"login.server_name", login.server_name},
          {"login.certificate", login.certificate},
          {"login.key", login.key}};
}

RoomPlan plan_of(const Fields& projectors, const Fields& wall, const SetupFacts& facts) {
  RoomPlan plan;
  plan.is_round = text_in(wall, "shape") != "flat";
  for (const Measure& measure : kMeasures) {
    if (const auto value = number_in(wall, measure.name)) plan.*measure.value = *value;
  }
  for (int i = 1; i <= count_of(projectors); ++i) {
    PlannedProjector projector;
    projector.name = text_in(projectors, of_projector(i, "name"));
    projector.connector = text_in(projectors, of_projector(i, "connector"));
    projector.pjlink = text_in(projectors, of_projector(i, "pjlink"));
    const auto turn = parse_integer(text_in(projectors, of_projector(i, "turn_deg")));
    projector.turn_deg = turn && *turn > 0 && *turn < 360 ? static_cast<int>(*turn) : 0;
    const auto plugged = std::ranges::find(facts.plugged, projector.connector, &PluggedProjector::connector);
    if (plugged != facts.plugged.end()) {
      projector.width_px = plugged->width_px;
      projector.height_px = plugged->height_px;
    }
    plan.projectors.push_back(std::move(projector));
  }
  return plan;
}

}  // namespace cyclorama::setup
