// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/png.h"
#include "kiosk/operator/frame_stages.h"
#include "kiosk/operator/picture_check.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kDropped = "dropped: ";
constexpr double kFrozenShare = 0.002;
constexpr auto kMaxAbsence = std::chrono::seconds(3);
constexpr int kSheetCellPx = 480;

bool is_watched(const Recording& recording, std::string_view name) {
  const auto& processes = recording.processes();
  return std::any_of(processes.begin(), processes.end(),
                     [&](const RecordedProcess& p) { return p.last.endpoint.name == name; });
}

const RecordedPicture* find(const Recording& recording, const std::string& name) {
  const auto found = recording.pictures().find(name);
  return found == recording.pictures().end() || found->second.newest.empty() ? nullptr : &found->second;
}

void judge_processes(const Recording& recording, std::vector<std::string>* problems) {
  for (const RecordedProcess& process : recording.processes()) {
    const std::string& name = process.last.endpoint.name;
    if (process.last.away) {
      problems->push_back(fmt::format("{} is away. {}", name, process.last.sentence));
    } else if (!process.last.is_well()) {
      problems->push_back(fmt::format("{} is not well: {}", name, process.last.sentence));
    } else if (process.max_absence > kMaxAbsence) {
      problems->push_back(fmt::format("{} did not answer for {:.1f} s", name, to_seconds(process.max_absence)));
    }
  }
}

void judge_picture(const Recording& recording, const std::string& name, const char* process, bool moves,
                   std::vector<std::string>* problems) {
  if (!is_watched(recording, process)) return;
  const RecordedPicture* const picture = find(recording, name);
  if (picture == nullptr) {
    problems->push_back(fmt::format("the picture '{}' of {} never came", name, process));
  } else if (is_blank(picture->newest)) {
    problems->push_back(fmt::format("the picture '{}' of {} is blank", name, picture->process));
  } else if (moves && picture->max_changed < kFrozenShare) {
    problems->push_back(fmt::format("the picture '{}' of {} is frozen: it did not change while it was recorded", name,
                                    picture->process));
  }
}

void judge_pictures(const Recording& recording, bool moves, std::vector<std::string>* problems) {
  judge_picture(recording, "panorama", "display", moves, problems);
  judge_picture(recording, "wall", "simulated-room", moves, problems);
  judge_picture(recording, "camera", "tracker", false, problems);
  bool projectors = false;
  for (const auto& [key, picture] : recording.pictures()) {
    if (!key.starts_with("projector/")) continue;
    projectors = true;
    judge_picture(recording, key, "display", false, problems);
  }
  if (!projectors && is_watched(recording, "display")) problems->push_back("the display shows no projector's picture");
}

Json stages_json(const wire::ProcessStatus& tour) {
  Json stages = Json::object();
  for (const wire::Stage& stage : in_frame_order(tour)) {
    stages[stage.name()] = {
        {"p50_ms", stage.p50_ms()}, {"p95_ms", stage.p95_ms()}, {"p99_ms", stage.p99_ms()}, {"count", stage.count()}};
  }
  return stages;
}

Json drops_json(const wire::ProcessStatus& tour) {
  Json drops = Json::object();
  for (const wire::Gauge& gauge : tour.gauges()) {
    if (gauge.name().starts_with(kDropped)) drops[gauge.name().substr(kDropped.size())] = gauge.value();
  }
  return drops;
}

/// Returns the number of nodes that the farm has, if the farm is watched; otherwise the number of nodes that rendered
/// the last frame.
int count_nodes(const Recording& recording, const wire::ProcessStatus& tour) {
  for (const RecordedProcess& process : recording.processes()) {
    if (process.last.endpoint.name == "tour" || !process.last.status) continue;
    if (const auto nodes = gauge_of(*process.last.status, "nodes")) return static_cast<int>(*nodes);
  }
  return static_cast<int>(gauge_of(tour, "nodes").value_or(0.0));
}

/// Turns "projector/left" into "projector-left.png", so that no name leaves the folder.
std::string file_name(const std::string& key) {
  std::string name;
  for (const char c : key) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    name += plain ? c : '-';
  }
  return name + ".png";
}

}  // namespace

std::vector<std::string> problems_of(const Recording& recording, const RecordedSpan& span) {
  std::vector<std::string> problems;
  judge_processes(recording, &problems);
  if (span.frames < span.frames_wanted) {
    problems.push_back(fmt::format("{:.0f} frames were presented in {:.1f} s; at least {:.0f} were expected",
                                   span.frames, span.seconds, span.frames_wanted));
  }
  judge_pictures(recording, span.frames > 0.0, &problems);  // A still wall is a problem only if there were frames.
  if (const wire::ProcessStatus* const tour = recording.status_of("tour");
      tour != nullptr && is_watched(recording, "tracker")) {
    const bool posed = std::any_of(tour->stages().begin(), tour->stages().end(),
                                   [](const wire::Stage& s) { return s.name() == "steer" && s.count() > 0; });
    if (!posed)
      problems.push_back(
          "no view ever followed a tag's pose: the tag was not found, or the tracker does not reach the tour");
  }
  return problems;
}

std::string summary_json(const Recording& recording, const RecordedSpan& span,
                         const std::vector<std::string>& problems) {
  const wire::ProcessStatus* const known = recording.status_of("tour");
  const wire::ProcessStatus tour = known == nullptr ? wire::ProcessStatus() : *known;
  const auto gauge = [&](std::string_view name) { return gauge_of(tour, name).value_or(0.0); };
  const wire::ProcessStatus* const display = recording.status_of("display");
  const auto shown_gauge = [&](std::string_view name) {
    return display == nullptr ? 0.0 : gauge_of(*display, name).value_or(0.0);
  };
  Json json{{"scene", fact_of(tour, "scene")},
            {"title", fact_of(tour, "title")},
            {"triangles", parse_integer(fact_of(tour, "triangles")).value_or(0)},
            {"nodes", count_nodes(recording, tour)},
            {"seconds", span.seconds},
            {"frames", static_cast<std::int64_t>(span.frames)},
            {"fps", span.seconds > 0.0 ? span.frames / span.seconds : 0.0},
            {"shown_hz", span.seconds > 0.0 ? span.poses / span.seconds : 0.0},
            {"eye_missed_m", shown_gauge("eye_missed_m")},
            {"scale", gauge("picture_scale")},
            {"samples", gauge("samples_per_pixel")},
            {"wasted", gauge("wasted_frames_share")},
            {"bytes_per_frame", gauge("bytes_per_frame")},
            {"balance_efficiency", gauge("balance_efficiency")},
            {"first_picture_s", nullptr},
            {"stages", stages_json(tour)},
            {"drops", drops_json(tour)},
            {"processes", Json::object()},
            {"ok", problems.empty()},
            {"problems", problems}};
  if (span.first_picture_s) json["first_picture_s"] = *span.first_picture_s;
  for (const RecordedProcess& process : recording.processes()) {
    json["processes"][process.last.endpoint.name] = {{"state", process.last.sentence},
                                                     {"healthy", process.last.is_well()}};
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Status write_recording(const Recording& recording, const std::filesystem::path& folder, const std::string& summary) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) {
    return Error(ErrorCode::kSystem, fmt::format("making the folder '{}': {}", folder.string(), failed.message()));
  }
  std::vector<std::vector<RgbImage>> rows;
  for (const char* const name : {"wall", "panorama", "camera"}) {
    const RecordedPicture* const picture = find(recording, name);
    if (picture != nullptr) rows.push_back(picture->overtime);
  }
  for (const auto& [key, picture] : recording.pictures()) {
    if (!picture.newest.empty()) TRY(write_png(folder / file_name(key), picture.newest));
  }
  if (!rows.empty()) TRY(write_png(folder / "wall-over-time.png", contact_sheet(rows, kSheetCellPx)));
  return write_file_atomically(folder / "summary.json", std::string_view(summary));
}

}  // namespace cyclorama::operations
