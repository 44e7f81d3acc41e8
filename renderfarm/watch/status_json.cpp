// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/status_json.h"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace cyclorama::watch {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the JSON text. Replaces bytes that are not UTF-8, so that text from a peer cannot break a page.
std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

constexpr double kWhole = 9007199254740992.0;  // 2^53

Json value_of(const wire::Cell& cell) {
  if (cell.value_case() == wire::Cell::kText) return cell.text();
  if (cell.value_case() == wire::Cell::kNumber) {
    // Whole numbers, such as the numbers of sessions and frames, are written without a fraction.
    const double number = cell.number();
    if (number == std::trunc(number) && std::abs(number) < kWhole) return static_cast<std::int64_t>(number);
    return number;
  }
  return nullptr;
}

Json rows_of(const wire::Table& table) {
  Json rows = Json::array();
  for (const wire::Row& row : table.rows()) {
    Json json = Json::object();
    const int count = std::min(table.columns_size(), row.cells_size());
    for (int i = 0; i < count; ++i) json[table.columns(i)] = value_of(row.cells(i));
    rows.push_back(std::move(json));
  }
  return rows;
}

}  // namespace

std::string status_json(const wire::ProcessStatus& status) {
  Json json{{"process", status.process()}, {"version", status.version()}, {"uptime_s", status.uptime_s()},
            {"state", status.state()},     {"healthy", status.healthy()}, {"gauges", Json::object()},
            {"facts", Json::object()},     {"stages", Json::object()}};
  for (const wire::Gauge& gauge : status.gauges()) json["gauges"][gauge.name()] = gauge.value();
  for (const wire::Fact& fact : status.facts()) json["facts"][fact.name()] = fact.value();
  for (const wire::Stage& stage : status.stages()) {
    json["stages"][stage.name()] = {
        {"count", stage.count()}, {"p50_ms", stage.p50_ms()}, {"p95_ms", stage.p95_ms()}, {"p99_ms", stage.p99_ms()}};
  }
  for (const wire::Table& table : status.tables()) json[table.name()] = rows_of(table);
  return dumped(json);
}

std::string table_json(const wire::ProcessStatus& status, const std::string& name) {
  for (const wire::Table& table : status.tables()) {
    if (table.name() == name) return dumped(rows_of(table));
  }
  return dumped(Json::array());
}

}  // namespace cyclorama::watch
