// SPDX-License-Identifier: Apache-2.0
// The contract of Turnplate, kept by each kind: serial on a pseudo-terminal, manual with somebody who does as told, and
// simulated in a museum that is not there.
#include "drivers/turnplate/turnplate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <memory>

#include "drivers/simulated/museum/truth.h"
#include "drivers/simulated/turntable/simulated_turnplate.h"
#include "drivers/turnplate/manual/manual_turnplate.h"
#include "drivers/turnplate/serial/serial_turnplate.h"
#include "tests/doubles/scripted_controller.h"

namespace cyclorama::turnplate {
namespace {

using std::chrono::milliseconds;
constexpr TurnRange kRange{-1.5, 2.0};

/// Where a plate of one kind stands. `break_next` makes its next movement fail for a while, as this kind can fail.
class Place {
 public:
  virtual ~Place() = default;
  virtual std::unique_ptr<Turnplate> open() = 0;
  /// False: this kind never stalls.
  virtual bool stall_next() = 0;
  virtual void free() {}
};

class SerialPlace final : public Place {
 public:
  std::unique_ptr<Turnplate> open() override {
    SerialTurnplateOptions options;
    options.device = controller_.device();
    options.range = kRange;
    options.speed_rad_s = 50.0;
    auto plate = SerialTurnplate::open(options);
    CHECK(plate.has_value());
    return *std::move(plate);
  }
  bool stall_next() override {
    controller_.block(true);
    return true;
  }
  void free() override { controller_.block(false); }

 private:
  ScriptedController controller_;
};

class ObedientOperator final : public TurnplateOperator {
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
  std::unique_ptr<Turnplate> open() override {
    return std::make_unique<ManualTurnplate>(std::make_unique<ObedientOperator>(&is_away_), kRange);
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
  std::unique_ptr<Turnplate> open() override {
    return std::make_unique<simulated::SimulatedTurnplate>(museum_.get(), kRange);
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

class TurnplateContract : public ::testing::TestWithParam<Kind> {
 protected:
  std::unique_ptr<Place> place_ = GetParam().make();
  std::unique_ptr<Turnplate> plate_ = place_->open();
};
INSTANTIATE_TEST_SUITE_P(Each, TurnplateContract,
                         ::testing::Values(Kind{"serial", make_place<SerialPlace>},
                                           Kind{"manual", make_place<ManualPlace>},
                                           Kind{"simulated", make_place<SimulatedPlace>}),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(TurnplateContract, knows_no_angle_before_it_was_home) {
  EXPECT_FALSE(plate_->id().empty());
  EXPECT_FALSE(plate_->is_homed());
  EXPECT_EQ(plate_->turn_to(0.1).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(plate_->angle().error().code(), ErrorCode::kInvalidArgument);
}

TEST_P(TurnplateContract, homes_and_turns_where_it_is_told) {
  ASSERT_TRUE(plate_->home());
  EXPECT_TRUE(plate_->is_homed());
  EXPECT_NEAR(*plate_->angle(), 0.0, 1e-3);
  for (const double angle : {0.5, kRange.max_rad, -0.25, kRange.min_rad, 0.0}) {
    ASSERT_TRUE(plate_->turn_to(angle));
    EXPECT_NEAR(*plate_->angle(), angle, 1e-3);
  }
}

TEST_P(TurnplateContract, keeps_its_limits) {
  ASSERT_TRUE(plate_->home());
  ASSERT_TRUE(plate_->turn_to(0.3));
  for (const double angle : {kRange.max_rad + 0.01, kRange.min_rad - 0.01, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(plate_->turn_to(angle).error().code(), ErrorCode::kInvalidArgument);
    EXPECT_TRUE(plate_->is_homed());
  }
  EXPECT_NEAR(*plate_->angle(), 0.3, 1e-3);
}

TEST_P(TurnplateContract, a_stall_is_told_and_mended_by_going_home) {
  ASSERT_TRUE(plate_->home());
  if (!place_->stall_next()) GTEST_SKIP() << "this kind never stalls";
  EXPECT_EQ(plate_->turn_to(1.0).error().code(), ErrorCode::kTimedOut);
  EXPECT_FALSE(plate_->is_homed());
  EXPECT_EQ(plate_->turn_to(1.0).error().code(), ErrorCode::kInvalidArgument);
  place_->free();
  ASSERT_TRUE(plate_->home());
  EXPECT_TRUE(plate_->turn_to(1.0));
}

}  // namespace
}  // namespace cyclorama::turnplate
