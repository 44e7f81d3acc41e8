// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/farm_tables.h"

#include <fmt/format.h>

#include <string_view>

namespace cyclorama::watch {
namespace {

/// Fills a table row by row, so that in the code each column's name is next to its value.
class TableWriter {
 public:
  explicit TableWriter(const char* name) { table_.set_name(name); }
  void next_row() { row_ = table_.add_rows(); }
  void text(const char* column, const std::string& value) { cell(column)->set_text(value); }
  void number(const char* column, double value) { cell(column)->set_number(value); }
  void count(const char* column, std::uint64_t value) { number(column, static_cast<double>(value)); }
  [[nodiscard]] wire::Table take() && { return std::move(table_); }

 private:
  wire::Cell* cell(const char* column) {
    if (table_.columns_size() == row_->cells_size()) table_.add_columns(column);
    return row_->add_cells();
  }
  wire::Table table_;
  wire::Row* row_ = nullptr;
};

}  // namespace

wire::Table sessions_table(const FarmOverview& farm) {
  TableWriter writer("sessions");
  for (const WatchedSession& session : farm.sessions) {
    writer.next_row();
    writer.count("id", session.id);
    writer.text("museum", session.museum);
    writer.text("scene", session.scene);
    writer.number("frames_per_second", session.frames_per_second);
    writer.number("samples_per_pixel", session.samples_per_pixel);
    writer.number("scale", session.scale);
    writer.number("width_px", session.width_px);
    writer.number("height_px", session.height_px);
    writer.number("budget_ms", session.budget_ms);
    writer.number("frame_ms", session.frame_ms);
    writer.number("bytes_per_frame", session.bytes_per_frame);
    writer.number("balance_efficiency", session.balance_efficiency);
    writer.count("frames", session.frames);
    writer.count("refined_frames", session.refined);
    writer.count("late_frames", session.late);
    writer.count("given_up_frames", session.given_up);
    writer.text("light", session.light);
  }
  return std::move(writer).take();
}

wire::Table nodes_table(const FarmOverview& farm) {
  TableWriter writer("nodes");
  for (const WatchedNode& node : farm.nodes) {
    writer.next_row();
    writer.text("name", node.name);
    writer.text("state", node.state);
    writer.number("threads", node.threads);
    writer.number("speed", node.speed);
    writer.count("blocks", node.blocks);
    writer.count("blocks_waiting", node.blocks_waiting);
    writer.count("memory_bytes", node.memory_bytes);
    writer.number("load_share", node.load_share);
    writer.number("uptime_s", node.uptime_s);
    writer.text("scenes", fmt::format("{}", fmt::join(node.scenes, ", ")));
    writer.text("light", fmt::format("{}", fmt::join(node.light, ", ")));
  }
  return std::move(writer).take();
}

}  // namespace cyclorama::watch
