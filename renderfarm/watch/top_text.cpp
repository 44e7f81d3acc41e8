// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/top_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>

#include "common/base/text.h"

namespace cyclorama::watch {
namespace {

struct Column {
  std::string_view key;
  std::string_view heading;
  int width;         ///< Text is cut to this width.
  int decimals;      ///< Decimals of a number; -1 for text.
  double per = 1.0;  ///< Unit in which the number is shown.
};

constexpr int kText = -1;
constexpr std::array<Column, 14> kSessions{{{"museum", "museum", 24, kText},
                                            {"scene", "scene", 16, kText},
                                            {"frames_per_second", "frames/s", 9, 1},
                                            {"samples_per_pixel", "samples", 8, 0},
                                            {"scale", "scale", 6, 2},
                                            {"budget_ms", "budget ms", 10, 0},
                                            {"frame_ms", "frame ms", 9, 1},
                                            {"bytes_per_frame", "kB/frame", 9, 0, 1e3},
                                            {"balance_efficiency", "balance", 8, 2},
                                            {"late_frames", "late", 7, 0},
                                            {"given_up_frames", "given up", 9, 0},
                                            {"frames", "frames", 10, 0},
                                            {"", "", 2, kText},
                                            {"light", "light", 40, kText}}};
constexpr std::array<Column, 11> kNodes{{{"name", "node", 24, kText},
                                         {"state", "state", 16, kText},
                                         {"threads", "threads", 9, 0},
                                         {"speed", "speed", 8, 2},
                                         {"load_share", "load", 6, 2},
                                         {"blocks", "blocks", 10, 0},
                                         {"blocks_waiting", "waiting", 9, 0},
                                         {"memory_bytes", "memory MB", 10, 0, 1e6},
                                         {"", "", 2, kText},
                                         {"scenes", "scenes", 32, kText},
                                         {"light", "light", 32, kText}}};

/// Stages in the order in which a frame passes them. Other stages follow.
constexpr std::array<std::string_view, 8> kStages{"queue",  "plan",  "fan_out",  "render",
                                                  "encode", "relay", "overhead", "farm"};

/// Cuts or pads `text` to exactly `width` characters.
std::string fitted(std::string_view text, std::size_t width) {
  const std::string clean = printable(text, 4 * width);
  std::size_t characters = 0;
  std::size_t end = 0;
  for (; end < clean.size(); ++end) {
    const bool begins = (static_cast<unsigned char>(clean[end]) & 0xc0U) != 0x80;
    if (begins && ++characters > width) break;
  }
  return clean.substr(0, end) + std::string(width - std::min(characters, width), ' ');
}

const wire::Cell* cell_of(const wire::Table& table, const wire::Row& row, std::string_view key) {
  const auto column = std::find(table.columns().begin(), table.columns().end(), key);
  const auto index = static_cast<int>(column - table.columns().begin());
  return column == table.columns().end() || index >= row.cells_size() ? nullptr : &row.cells(index);
}

std::string cell_text(const Column& column, const wire::Cell* cell) {
  if (column.decimals == kText)
    return fitted(cell == nullptr ? "" : cell->text(), static_cast<std::size_t>(column.width));
  if (cell == nullptr || cell->value_case() != wire::Cell::kNumber) return fmt::format("{:>{}}", "-", column.width);
  return fmt::format("{:>{}.{}f}", cell->number() / column.per, column.width, column.decimals);
}

class Lines {
 public:
  explicit Lines(int columns) : columns_(static_cast<std::size_t>(std::max(columns, 1))) {}
  void add(std::string_view line) {
    std::string text = fitted(line, columns_);
    text.erase(text.find_last_not_of(' ') + 1);
    text_ += text + '\n';
  }
  [[nodiscard]] std::string take() && { return std::move(text_); }

 private:
  std::size_t columns_;
  std::string text_;
};

void add_table(const wire::ProcessStatus& status, std::string_view name, std::span<const Column> columns,
               Lines* lines) {
  const auto table = std::find_if(status.tables().begin(), status.tables().end(),
                                  [&](const wire::Table& candidate) { return candidate.name() == name; });
  lines->add("");
  std::string heading;
  for (const Column& column : columns) {
    heading += column.decimals == kText ? fitted(column.heading, static_cast<std::size_t>(column.width))
                                        : fmt::format("{:>{}}", column.heading, column.width);
  }
  lines->add(heading);
  if (table == status.tables().end() || table->rows().empty()) return lines->add("(none)");
  for (const wire::Row& row : table->rows()) {
    std::string line;
    for (const Column& column : columns) line += cell_text(column, cell_of(*table, row, column.key));
    lines->add(line);
  }
}

void add_stages(const wire::ProcessStatus& status, Lines* lines) {
  lines->add("");
  lines->add(fmt::format("{:<24}{:>10}{:>10}{:>10}{:>12}", "step of a frame", "p50 ms", "p95 ms", "p99 ms", "count"));
  std::vector<const wire::Stage*> stages;
  for (const wire::Stage& stage : status.stages()) stages.push_back(&stage);
  std::ranges::stable_sort(stages, {},
                           [](const wire::Stage* stage) { return std::ranges::find(kStages, stage->name()); });
  if (stages.empty()) lines->add("(none yet)");
  for (const wire::Stage* const stage : stages) {
    lines->add(fmt::format("{}{:>10.2f}{:>10.2f}{:>10.2f}{:>12}", fitted(stage->name(), 24), stage->p50_ms(),
                           stage->p95_ms(), stage->p99_ms(), stage->count()));
  }
}

std::optional<double> gauge_of(const wire::ProcessStatus& status, std::string_view name) {
  for (const wire::Gauge& gauge : status.gauges()) {
    if (gauge.name() == name) return gauge.value();
  }
  return std::nullopt;
}

std::string duration_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.0f} min", seconds / 60.0);
  if (seconds < 172800.0) return fmt::format("{:.0f} h", seconds / 3600.0);
  return fmt::format("{:.0f} days", seconds / 86400.0);
}

}  // namespace

std::string top_text(const wire::ProcessStatus& status, int columns) {
  Lines lines(columns);
  lines.add(fmt::format("cyclorama-farm {}, up {}: {}{}", status.version(), duration_text(status.uptime_s()),
                        status.healthy() ? "" : "NOT WELL: ", status.state()));
  lines.add(fmt::format("{:.1f} frames/s, {:.2f} M rays/s", gauge_of(status, "frames_per_second").value_or(0.0),
                        1e-6 * gauge_of(status, "rays_per_second").value_or(0.0)));
  add_table(status, "sessions", kSessions, &lines);
  add_table(status, "nodes", kNodes, &lines);
  add_stages(status, &lines);
  return std::move(lines).take();
}

}  // namespace cyclorama::watch
