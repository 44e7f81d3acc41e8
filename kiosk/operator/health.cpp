// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/health.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "common/image/image_file.h"
#include "common/image/jpeg.h"
#include "kiosk/operator/picture_check.h"

namespace cyclorama::operations {
namespace {

constexpr std::string_view kLit = "lit: ";
constexpr std::string_view kHeadPicture = "projector/";
constexpr std::size_t kMaxSentenceLength = 300;

bool is_display(const ProcessObservation& process) {
  return process.status && !fact_of(*process.status, "heads").empty();
}

std::vector<std::string> heads_of(const ProcessObservation& display) {
  std::vector<std::string> heads;
  for (const wire::Gauge& gauge : display.status->gauges()) {
    if (gauge.name().starts_with(kLit)) heads.push_back(gauge.name().substr(kLit.size()));
  }
  return heads;
}

/// True if a healthy display keeps its heads dark because the museum is closed.
bool sleeps(const ProcessObservation& display) {
  return display.status->healthy() && gauge_of(*display.status, "awake").value_or(1.0) == 0.0;
}

bool is_dark(const ProcessObservation& display, const std::string& head) {
  return gauge_of(*display.status, std::string(kLit) + head).value_or(0.0) == 0.0;
}

void judge_display(const ProcessObservation& display, const HealthSnapshot& look,
                   const std::set<std::string>& may_be_dark, std::vector<std::string>* missing) {
  for (const std::string& head : heads_of(display)) {
    const std::string who = fmt::format("{}: head '{}'", display.endpoint.name, printable(head));
    if (is_dark(display, head) && !sleeps(display) && !may_be_dark.contains(head)) {
      missing->push_back(fmt::format("{} is dark. {}", who, printable(display.sentence, kMaxSentenceLength)));
      continue;
    }
    const auto picture = look.is_blank.find({display.endpoint.name, std::string(kHeadPicture) + head});
    if (picture == look.is_blank.end()) {
      missing->push_back(fmt::format("{} has given no picture yet", who));
    } else if (picture->second) {
      missing->push_back(fmt::format("{} has a picture, but it is blank", who));
    }
  }
}

}  // namespace

std::vector<std::string> still_missing(const HealthSnapshot& look, const HealthRules& rules) {
  std::vector<std::string> missing;
  std::size_t heads = 0;
  for (const ProcessObservation& process : look.processes) {
    const std::string& name = process.endpoint.name;
    if (!process.asked || process.away) {
      missing.push_back(fmt::format("{} is away. {}", name, printable(process.sentence, kMaxSentenceLength)));
      continue;
    }
    const bool must_be_well = std::find(rules.well.begin(), rules.well.end(), name) != rules.well.end();
    if (must_be_well && !process.is_well()) {
      missing.push_back(fmt::format("{} is not well: {}", name, printable(process.sentence, kMaxSentenceLength)));
    }
    if (!is_display(process)) continue;
    heads += heads_of(process).size();
    judge_display(process, look, rules.may_be_dark, &missing);
  }
  for (const std::string& name : rules.well) {
    const bool known = std::any_of(look.processes.begin(), look.processes.end(),
                                   [&](const ProcessObservation& process) { return process.endpoint.name == name; });
    if (!known)
      missing.push_back(fmt::format("{} must be well, but it is not watched; add --watch {}=ADDRESS", name, name));
  }
  if (heads < static_cast<std::size_t>(std::max(rules.heads, 0))) {
    missing.push_back(fmt::format("the displays have {} heads of {}", heads, rules.heads));
  }
  return missing;
}

void HealthCount::take(const HealthSnapshot& look) {
  missing_ = still_missing(look, rules_);
  for (const ProcessObservation& process : look.processes) {
    if (process.away || !process.status) continue;
    const auto [known, is_new] = uptimes_s_.try_emplace(process.endpoint.name, process.status->uptime_s());
    if (!is_new && process.status->uptime_s() < known->second) {
      missing_.push_back(fmt::format("{} was started again meanwhile", process.endpoint.name));
    }
    known->second = process.status->uptime_s();
  }
  in_a_row_ = missing_.empty() ? in_a_row_ + 1 : 0;
}

HealthSnapshot look_at(const std::vector<ProcessLink>& links) {
  HealthSnapshot look;
  for (const ProcessLink& link : links) {
    look.processes.push_back(observe(link, {}));
    const ProcessObservation& process = look.processes.back();
    if (process.away || !is_display(process)) continue;
    for (const std::string& head : heads_of(process)) {
      const std::string name = std::string(kHeadPicture) + head;
      const auto answer = link.picture(name);  // A picture is rendered only after the first request for it.
      if (!answer) continue;
      const auto picture = JpegDecoder().decode(std::as_bytes(std::span(answer->jpeg())), kPhotoLimitPx);
      if (picture) look.is_blank[{process.endpoint.name, name}] = is_blank(*picture);
    }
  }
  return look;
}

std::set<std::string> dark_heads(const HealthSnapshot& look) {
  std::set<std::string> dark;
  for (const ProcessObservation& process : look.processes) {
    if (!process.asked || process.away || !is_display(process)) continue;
    for (const std::string& head : heads_of(process)) {
      if (is_dark(process, head)) dark.insert(head);
    }
  }
  return dark;
}

std::string health_json(const HealthCount& count, double seconds) {
  const nlohmann::ordered_json json{
      {"well", count.is_well()}, {"seconds", seconds}, {"version", CYCLORAMA_VERSION}, {"missing", count.missing()}};
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace cyclorama::operations
