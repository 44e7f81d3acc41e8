// SPDX-License-Identifier: Apache-2.0
// The contract of Turntable, tested for each kind: serial on a pseudo-terminal, manual with an obedient operator, and
// simulated in a simulated museum.
#include "drivers/turntable/turntable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <memory>

#include "drivers/simulated/museum/truth.h"
#include "drivers/simulated/turntable/simulated_turntable.h"
#include "drivers/turntable/manual/manual_turntable.h"
#include "drivers/turntable/serial/serial_turntable.h"
#include "tests/doubles/scripted_controller.h"

namespace cyclorama::turntable {
namespace {

using std::chrono::milliseconds;
constexpr TurnRange kRange{-1.5, 2.0};

/// Makes a turntable of one kind. `break_next` makes its next movement fail for a while, in the way that this kind can.
class Place {
 public:
  virtual ~Place() = default;
  virtual std::unique_ptr<Turntable> open() = 0;
  /// Returns false if this kind never stalls.
  virtual bool stall_next() = 0;
  virtual void free() {}
};

class SerialPlace final : public Place {
 public:
  std::unique_ptr<Turntable> open() override {
    SerialTurntableOptions options;
    options.device = controller_.device();
    options.range = kRange;
    options.speed_rad_s = 50.0;
    auto turntable = SerialTurntable::open(options);
    CHECK(turntable.has_value());
    return *std::move(turntable);
  }
  bool stall_next() override {
    controller_.block(true);
    return true;
  }
  void free() override { controller_.block(false); }

 private:
  ScriptedController controller_;
};

class ObedientOperator final : public TurntableOperator {
 public:
  explicit ObedientOperator(bool* is_away) : is_away_(is_away) {}
  Result<std::string> answer(const std::string&, milliseconds) override {
    if (*is_away_) return Error(ErrorCode::kTimedOut, "nobody is here");
    return std::string();
  }

 private:
  bool* is_away_;
};

class ManualPlace final : public Place {
 public:
  std::unique_ptr<Turntable> open() override {
    return std::make_unique<ManualTurntable>(std::make_unique<ObedientOperator>(&is_away_), kRange);
  }
  bool stall_next() override { return is_away_ = true; }
  void free() override { is_away_ = false; }

 private:
  bool is_away_ = false;
};

class SimulatedPlace final : public Place {
 public:
  SimulatedPlace() {
    const Installation installation = *parse_installation(R"(
name = "room"
[wall]
radius_m = 3.0
arc_deg = 120
top_m = 2.5
[visitor]
eye_m = [0, 1.6, 0]
[[projector]]
name = "one"
width_px = 32
height_px = 24
field_of_view_deg = 50
position_m = [0, 2.4, 1.0]
)",
                                                          "room");
    simulated::MuseumTruth truth = simulated::MuseumTruth::ideal(installation);
    truth.cells = 0;
    truth.camera.lens = simulated::TrueLens(Pinhole::from_field_of_view(16, 12, 1.0));
    museum_ = std::make_unique<simulated::SimulatedMuseum>(*simulated::SimulatedMuseum::make(installation, truth, 1));
  }
  std::unique_ptr<Turntable> open() override {
    return std::make_unique<simulated::SimulatedTurntable>(museum_.get(), kRange);
  }
  bool stall_next() override { return false; }

 private:
  std::unique_ptr<simulated::SimulatedMuseum> museum_;
};

template <typename PlaceOfKind>
std::unique_ptr<Place> make_place() {
  return std::make_unique<PlaceOfKind>();
}
struct Kind {
  const char* name;
  std::unique_ptr<Place> (*make)();
};

class TurntableContract : public ::testing::TestWithParam<Kind> {
 protected:
  std::unique_ptr<Place> place_ = GetParam().make();
  std::unique_ptr<Turntable> turntable_ = place_->open();
};
INSTANTIATE_TEST_SUITE_P(Each, TurntableContract,
                         ::testing::Values(Kind{"serial", make_place<SerialPlace>},
                                           Kind{"manual", make_place<ManualPlace>},
                                           Kind{"simulated", make_place<SimulatedPlace>}),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(TurntableContract, has_no_angle_before_homing) {
  EXPECT_FALSE(turntable_->id().empty());
  EXPECT_FALSE(turntable_->is_homed());
  EXPECT_EQ(turntable_->turn_to(0.1).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(turntable_->angle().error().code(), ErrorCode::kInvalidArgument);
}

TEST_P(TurntableContract, homes_and_turns_to_the_requested_angle) {
  ASSERT_TRUE(turntable_->home());
  EXPECT_TRUE(turntable_->is_homed());
  EXPECT_NEAR(*turntable_->angle(), 0.0, 1e-3);
  for (const double angle : {0.5, kRange.max_rad, -0.25, kRange.min_rad, 0.0}) {
    ASSERT_TRUE(turntable_->turn_to(angle));
    EXPECT_NEAR(*turntable_->angle(), angle, 1e-3);
  }
}

TEST_P(TurntableContract, keeps_its_limits) {
  ASSERT_TRUE(turntable_->home());
  ASSERT_TRUE(turntable_->turn_to(0.3));
  for (const double angle : {kRange.max_rad + 0.01, kRange.min_rad - 0.01, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(turntable_->turn_to(angle).error().code(), ErrorCode::kInvalidArgument);
    EXPECT_TRUE(turntable_->is_homed());
  }
  EXPECT_NEAR(*turntable_->angle(), 0.3, 1e-3);
}

TEST_P(TurntableContract, reports_a_stall_and_recovers_by_homing) {
  ASSERT_TRUE(turntable_->home());
  if (!place_->stall_next()) GTEST_SKIP() << "this kind never stalls";
  EXPECT_EQ(turntable_->turn_to(1.0).error().code(), ErrorCode::kTimedOut);
  EXPECT_FALSE(turntable_->is_homed());
  EXPECT_EQ(turntable_->turn_to(1.0).error().code(), ErrorCode::kInvalidArgument);
  place_->free();
  ASSERT_TRUE(turntable_->home());
  EXPECT_TRUE(turntable_->turn_to(1.0));
}

}  // namespace
}  // namespace cyclorama::turntable
