// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <string_view>

namespace cyclorama::operations {
namespace {

constexpr std::string_view kDropped = "dropped: ";

std::string escaped(std::string_view text) {
  std::string label;
  for (const char c : text) {
    if (c == '\n') {
      label += "\\n";
      continue;
    }
    if (c == '\\' || c == '"') label += '\\';
    label += c;
  }
  return label;
}

std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);
}

class Text {
 public:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    fmt::format_to(std::back_inserter(text_), "# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
  }
  void sample(std::string_view name, std::string_view labels, double value) {
    fmt::format_to(std::back_inserter(text_), "{}{{{}}} {}\n", name, labels, number(value));
  }
  [[nodiscard]] std::string take() && { return std::move(text_); }

 private:
  std::string text_;
};

std::string process_label(const ProcessObservation& observation) {
  return fmt::format("process=\"{}\"", escaped(observation.endpoint.name));
}

void write_stages(const ProcessObservation& observation, Text* text) {
  for (const wire::Stage& stage : observation.status->stages()) {
    const std::string labels = fmt::format("{},stage=\"{}\"", process_label(observation), escaped(stage.name()));
    const auto quantile = [&](const char* q, double milliseconds) {
      text->sample("cyclorama_stage_seconds", fmt::format("{},quantile=\"{}\"", labels, q), milliseconds / 1e3);
    };
    quantile("0.5", stage.p50_ms());
    quantile("0.95", stage.p95_ms());
    quantile("0.99", stage.p99_ms());
    text->sample("cyclorama_stage_seconds_count", labels, static_cast<double>(stage.count()));
  }
}

void write_gauges(const ProcessObservation& observation, bool dropped, Text* text) {
  for (const wire::Gauge& gauge : observation.status->gauges()) {
    const bool is_drop = gauge.name().starts_with(kDropped);
    if (is_drop != dropped) continue;
    const std::string name = escaped(is_drop ? gauge.name().substr(kDropped.size()) : gauge.name());
    text->sample(is_drop ? "cyclorama_dropped_frames_total" : "cyclorama_gauge",
                 fmt::format("{},{}=\"{}\"", process_label(observation), is_drop ? "reason" : "name", name),
                 gauge.value());
  }
}

}  // namespace

std::string metrics_text(const std::vector<ProcessObservation>& observations) {
  Text text;
  const auto each_present = [&](const std::function<void(const ProcessObservation&)>& write) {
    for (const ProcessObservation& observation : observations) {
      if (!observation.away && observation.status) write(observation);
    }
  };
  text.family("cyclorama_up", "gauge", "1 when the process answers");
  for (const ProcessObservation& o : observations) text.sample("cyclorama_up", process_label(o), o.away ? 0 : 1);
  text.family("cyclorama_healthy", "gauge", "1 when the process says that all is well with it");
  each_present(
      [&](const ProcessObservation& o) { text.sample("cyclorama_healthy", process_label(o), o.is_well() ? 1 : 0); });
  text.family("cyclorama_uptime_seconds", "gauge", "Seconds since the process started");
  each_present([&](const ProcessObservation& o) {
    text.sample("cyclorama_uptime_seconds", process_label(o), o.status->uptime_s());
  });
  text.family("cyclorama_stage_seconds", "summary", "One step on a frame's way from shutter to photon");
  each_present([&](const ProcessObservation& o) { write_stages(o, &text); });
  text.family("cyclorama_dropped_frames_total", "counter", "Frames that were not shown, and why");
  each_present([&](const ProcessObservation& o) { write_gauges(o, true, &text); });
  text.family("cyclorama_gauge", "gauge", "A number that the process shows, with its unit in its name");
  each_present([&](const ProcessObservation& o) { write_gauges(o, false, &text); });
  return std::move(text).take();
}

std::string museum_metrics_text(const std::vector<Check>& checks, const care::VisitCounts::Day& visits) {
  Text text;
  text.family("cyclorama_checks", "gauge", "Checks of the museum by their level");
  for (const CheckLevel level : {CheckLevel::kOk, CheckLevel::kWarning, CheckLevel::kFault}) {
    const auto count = std::ranges::count(checks, level, &Check::level);
    text.sample("cyclorama_checks", fmt::format("level=\"{}\"", to_text(level)), static_cast<double>(count));
  }
  text.family("cyclorama_visits_total", "counter", "Visits that have ended");
  text.sample("cyclorama_visits_total", "", visits.visits);
  text.family("cyclorama_visit_seconds_total", "counter", "Their time together");
  text.sample("cyclorama_visit_seconds_total", "", visits.seconds);
  return std::move(text).take();
}

}  // namespace cyclorama::operations
