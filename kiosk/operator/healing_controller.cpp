// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/healing_controller.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "common/wire/channel.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto kDeadline = std::chrono::seconds(2);
constexpr auto kGlance = std::chrono::milliseconds(500);  // The page polls each second.
constexpr int kMaxRows = 200;
constexpr int kMaxColumns = 65;
constexpr std::size_t kMaxCellLength = 300;

const wire::Table* table_of(const wire::ProcessStatus& status, const std::string& name) {
  const auto found = std::ranges::find(status.tables(), name, &wire::Table::name);
  return found == status.tables().end() ? nullptr : &*found;
}

Json json_of(const wire::Cell& cell) {
  if (cell.has_text()) return printable(cell.text(), kMaxCellLength);
  if (cell.has_number() && std::isfinite(cell.number())) return cell.number();
  return nullptr;
}

/// Returns the cell of the named column; null if there is none.
Json cell(const wire::Table& table, const wire::Row& row, const std::string& column) {
  const auto found = std::ranges::find(table.columns(), column);
  const auto index = static_cast<int>(found - table.columns().begin());
  return index < row.cells_size() ? json_of(row.cells(index)) : Json(nullptr);
}

}  // namespace

Result<std::unique_ptr<HealingController>> HealingController::make(const std::string& address) {
  TRY_ASSIGN(const auto channel, make_channel(address));
  return std::unique_ptr<HealingController>(new HealingController(channel));
}

HealingController::HealingController(const std::shared_ptr<grpc::Channel>& channel)
    : inspection_(wire::Inspection::NewStub(channel)), healing_(wire::Healing::NewStub(channel)) {}

std::string HealingController::json() const {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kGlance);
  wire::ProcessStatus status;
  if (!inspection_->GetStatus(&context, wire::StatusRequest(), &status).ok()) return "null";
  return watched_json(status);
}

Status HealingController::realign() {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);
  wire::RealignReply answer;
  const grpc::Status status = healing_->Realign(&context, wire::RealignRequest(), &answer);
  if (status.ok()) return Done{};
  return from_grpc(status, "realigning the projectors");
}

Result<std::string> HealingController::undo() {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);
  wire::RealignRequest order;
  order.set_undo(true);
  wire::RealignReply answer;
  const grpc::Status status = healing_->Realign(&context, order, &answer);
  if (!status.ok()) return from_grpc(status, "undoing the last correction");
  return printable(answer.undone(), 4 * kMaxCellLength);
}

std::string watched_json(const wire::ProcessStatus& calibrator) {
  const wire::Table* const now = table_of(calibrator, "watched projectors");
  if (now == nullptr) return "null";
  Json json{{"sentence", nullptr}, {"projectors", Json::array()}, {"names", Json::array()}, {"history", Json::array()}};
  for (const wire::Fact& fact : calibrator.facts()) {
    if (fact.name() == "watch") json["sentence"] = printable(fact.value(), 4 * kMaxCellLength);
  }
  for (const wire::Row& row : now->rows()) {
    if (json["projectors"].size() == kMaxRows) break;
    json["projectors"].push_back({{"name", cell(*now, row, "projector")},
                                  {"state", cell(*now, row, "state")},
                                  {"reason", cell(*now, row, "reason")},
                                  {"off_px", cell(*now, row, "off_px")},
                                  {"sigma_px", cell(*now, row, "sigma_px")},
                                  {"corrections", cell(*now, row, "corrections")},
                                  {"last_px", cell(*now, row, "last_correction_px")},
                                  {"last_s", cell(*now, row, "last_correction_s")},
                                  {"wants_scan", cell(*now, row, "wants_scan") == 1.0}});
  }
  if (const wire::Table* const past = table_of(calibrator, "watched history")) {
    const int columns = std::min(past->columns_size(), kMaxColumns);
    for (int i = 1; i < columns; ++i) json["names"].push_back(printable(past->columns(i), kMaxCellLength));
    for (const wire::Row& row : past->rows()) {
      if (json["history"].size() == kMaxRows) break;
      Json line = Json::array();
      for (int i = 0; i < columns; ++i) line.push_back(i < row.cells_size() ? json_of(row.cells(i)) : Json(nullptr));
      json["history"].push_back(std::move(line));
    }
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace cyclorama::operations
