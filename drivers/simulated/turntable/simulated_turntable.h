// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "drivers/simulated/museum/simulated_museum.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::simulated {

/// The turntable of a simulated museum: it reports nominal angles, and its true angles have the errors of the museum's
/// truth.
class SimulatedTurntable final : public turntable::Turntable {
 public:
  /// `museum` must outlive the turntable.
  explicit SimulatedTurntable(SimulatedMuseum* museum,
                              turntable::TurnRange range = {-std::numbers::pi, std::numbers::pi})
      : turntable::Turntable(range), museum_(museum) {}
  [[nodiscard]] const std::string& id() const override { return id_; }

 private:
  Status move_home() override { return move_to(0.0); }
  Status move_to(double angle_rad) override {
    museum_->turn_to(angle_rad);
    return Done{};
  }
  Result<double> ask_angle() override { return museum_->turntable_angle_rad(); }

  std::string id_ = "simulated";
  SimulatedMuseum* museum_;
};

}  // namespace cyclorama::simulated
