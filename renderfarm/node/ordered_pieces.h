// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/light_baking/piece_folder.h"

namespace cyclorama::node {

/// The pieces of light in a node's child process: computed when the node orders them, or fetched from other nodes. All
/// of them are kept in a folder. Reports and orders are those of LightProcess. Thread-bound.
class OrderedPieces final : public light_baking::LightPieces {
 public:
  /// `orders` is a socket that keeps messages apart, and is borrowed; `report` is called with a line, from any thread.
  OrderedPieces(std::filesystem::path folder, int orders, std::function<void(const std::string& line)> report)
      : folder_(std::move(folder)), orders_(orders), report_(std::move(report)) {}

  Status begin(const std::string& computation) override;
  /// Errors: kUnavailable if the orders end; those of keeping a piece.
  Status complete(const light_baking::LightStage& stage, const light_baking::StageWork& work) override;
  /// To be called once the light itself is in its file.
  void remove() const { folder_.remove(); }

 private:
  struct Order {
    bool is_fetched = false;
    std::uint32_t stage = 0;
    std::uint32_t piece = 0;
  };
  /// Waits for an order, then returns all that have come.
  [[nodiscard]] Result<std::vector<Order>> next_orders() const;
  [[nodiscard]] bool take_kept(const light_baking::LightStage& stage, const light_baking::StageWork& work,
                               std::uint32_t piece) const;
  [[nodiscard]] Status report(const light_baking::LightStage& stage, std::uint32_t piece) const;

  light_baking::PieceFolder folder_;
  const int orders_;
  const std::function<void(const std::string&)> report_;
};

}  // namespace cyclorama::node
