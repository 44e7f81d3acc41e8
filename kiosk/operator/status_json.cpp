// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/status_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "kiosk/operator/frame_stages.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

/// Replaces bytes that are not UTF-8: a peer's text must not break a page.
std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

Json stage_json(const wire::Stage& stage) {
  return {{"name", stage.name()},
          {"count", stage.count()},
          {"p50_ms", stage.p50_ms()},
          {"p95_ms", stage.p95_ms()},
          {"p99_ms", stage.p99_ms()}};
}

Json process_json(const ProcessObservation& observation) {
  Json json{{"name", observation.endpoint.name},
            {"address", observation.endpoint.address},
            {"asked", observation.asked},
            {"away", observation.away},
            {"healthy", observation.is_well()},
            {"state", observation.sentence},
            {"version", ""},
            {"uptime_s", nullptr},
            {"gauges", Json::object()},
            {"facts", Json::object()},
            {"pictures", Json::array()},
            {"stages", Json::array()}};
  if (!observation.status) return json;
  const wire::ProcessStatus& status = *observation.status;
  json["version"] = status.version();
  json["uptime_s"] = status.uptime_s();
  for (const wire::Gauge& gauge : status.gauges()) json["gauges"][gauge.name()] = gauge.value();
  for (const wire::Fact& fact : status.facts()) json["facts"][fact.name()] = fact.value();
  for (const std::string& picture : status.pictures()) json["pictures"].push_back(picture);
  for (const wire::Stage& stage : status.stages()) json["stages"].push_back(stage_json(stage));
  return json;
}

Json flow_json(const wire::ProcessStatus& tour) {
  Json flow = Json::array();
  for (const wire::Stage& stage : in_frame_order(tour)) {
    Json json = stage_json(stage);
    const auto known = std::find_if(kFrameStages.begin(), kFrameStages.end(),
                                    [&](const FrameStage& s) { return s.name == stage.name(); });
    json["where"] = known == kFrameStages.end() ? "other" : std::string(known->where);
    json["inside"] = known == kFrameStages.end() ? "" : std::string(known->inside);
    flow.push_back(std::move(json));
  }
  return flow;
}

}  // namespace

std::string status_json(const std::vector<ProcessObservation>& observations) {
  Json json{{"well", std::all_of(observations.begin(), observations.end(), [](const auto& o) { return o.is_well(); })},
            {"flow", Json::array()},
            {"processes", Json::array()}};
  for (const ProcessObservation& observation : observations) {
    json["processes"].push_back(process_json(observation));
    if (observation.endpoint.name == "tour" && observation.status) json["flow"] = flow_json(*observation.status);
  }
  return dumped(json);
}

Result<wire::SteerRequest> parse_steer(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) {
    return Error(ErrorCode::kBadData, "not a JSON object; send {\"forward\": 0, \"right\": 0, \"turn\": 0}");
  }
  wire::SteerRequest request;
  for (const auto& [key, value] : json.items()) {
    const bool known = key == "forward" || key == "right" || key == "turn";
    if (!known) return Error(ErrorCode::kBadData, fmt::format("'{}' is none of forward, right, turn", printable(key)));
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::abs(number) <= 1.0)) {
      return Error(ErrorCode::kBadData, fmt::format("'{}' must be a number from -1 to 1", key));
    }
    if (key == "forward") request.set_forward(number);
    if (key == "right") request.set_right(number);
    if (key == "turn") request.set_turn(number);
  }
  return request;
}

}  // namespace cyclorama::operations
