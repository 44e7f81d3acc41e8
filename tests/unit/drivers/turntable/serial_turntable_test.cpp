// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/serial/serial_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doubles/scripted_controller.h"

namespace cyclorama::turntable {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

SerialTurntableOptions quick(const ScriptedController& controller) {
  SerialTurntableOptions options;
  options.device = controller.device();
  options.speed_rad_s = 50.0;
  options.answer_timeout = milliseconds(150);
  options.home_timeout = milliseconds(200);
  return options;
}

/// Uses a turntable once: opens it, homes it, turns it, reads its angle. Returns the first error, if any.
std::optional<Error> visit(const SerialTurntableOptions& options, std::unique_ptr<Turntable>* ret_turntable) {
  auto opened = SerialTurntable::open(options);
  if (!opened) return opened.error();
  *ret_turntable = *std::move(opened);
  if (auto s = (*ret_turntable)->home(); !s) return s.error();
  if (auto s = (*ret_turntable)->turn_to(0.5); !s) return s.error();
  if (auto s = (*ret_turntable)->angle(); !s) return s.error();
  return std::nullopt;
}

/// A busy machine may delay an answer; only the final state counts.
bool goes_on(Turntable* turntable) {
  for (int i = 0; i < 20; ++i) {
    if (turntable->home() && turntable->turn_to(0.2)) return true;
  }
  return false;
}

TEST(SerialTurntable, sends_the_documented_commands) {
  ScriptedController controller;
  SerialTurntableOptions options = quick(controller);
  options.answer_timeout = milliseconds(3000);
  options.speed_rad_s = 0.5 * std::numbers::pi;
  std::unique_ptr<Turntable> turntable;
  ASSERT_FALSE(visit(options, &turntable));
  EXPECT_THAT(controller.heard(), ElementsAre("G90", "M114", "G90", "G28 X", "G0 X0.0000 F5400", "M400", "M114",
                                              "G0 X28.6479 F5400", "M400", "M114", "M114"));
  EXPECT_NEAR(controller.position(), 28.6479, 1e-9);
}

TEST(SerialTurntable, supports_units_of_steps_and_a_reversed_axis) {
  ScriptedController controller;
  SerialTurntableOptions options = quick(controller);
  options.answer_timeout = milliseconds(3000);
  options.units_per_turn = -1600.0;
  options.tolerance_rad = 0.01;
  std::unique_ptr<Turntable> turntable;
  ASSERT_FALSE(visit(options, &turntable));
  EXPECT_NEAR(controller.position(), -1600.0 * 0.5 / (2.0 * std::numbers::pi), 1e-3);
  EXPECT_NEAR(*turntable->angle(), 0.5, 1e-4);
}

// Each answer is corrupted in each way. The result must be an error with a matching message, in time, and a turntable
// that works again once the fault has gone, unless it was unplugged.
TEST(SerialTurntable, reports_any_failed_answer_and_works_afterwards) {
  struct Way {
    const char* name;
    ScriptedController::Fault fault;
    bool may_pass;  ///< True where the fault does no harm.
  };
  const std::vector<Way> ways{
      {"silence", {std::string()}, false},
      {"error", {"Error:Printer halted. kill() called!\n"}, false},
      {"halt", {"!! Lost communication\n"}, false},
      {"restart", {"start\necho:Marlin 2.1.2\n"}, false},
      {"noise", {std::string(2000, '\x7f')}, false},
      {"no line end", {"ok"}, false},
      {"wants it again for ever", {"Resend: 1\n"}, false},
      {"a position that is none", {"X:nan Y:0\nok\n"}, true},
      {"another axis", {"Y:0.00 Z:0.00\nok\n"}, true},
      {"busy for ever", {"echo:busy: processing\n"}, false},
      {"hangs up", {std::nullopt, true}, false},
  };
  constexpr std::size_t kLines = 11;
  for (const Way& way : ways) {
    for (std::size_t failing = 0; failing < kLines; ++failing) {
      SCOPED_TRACE(std::string(way.name) + " at line " + std::to_string(failing));
      std::atomic<bool> is_mended = false;
      std::atomic<bool> has_failed = false;
      ScriptedController controller(
          [&](std::size_t number, const std::string&) -> std::optional<ScriptedController::Fault> {
            // The failing line fails again when it is repeated, until the fault is removed.
            if (is_mended || number < failing) return std::nullopt;
            if (way.may_pass && number != failing) return std::nullopt;
            has_failed = true;
            return way.fault;
          });
      std::unique_ptr<Turntable> turntable;
      const auto error = visit(quick(controller), &turntable);
      EXPECT_TRUE(has_failed);
      if (way.fault.hangs_up) {
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::kUnavailable) << error->message();
        if (turntable) {
          EXPECT_EQ(turntable->home().error().code(), ErrorCode::kUnavailable);
          EXPECT_EQ(turntable->turn_to(0.1).error().code(), ErrorCode::kUnavailable);
          EXPECT_EQ(turntable->angle().error().code(), ErrorCode::kUnavailable);
        }
        continue;
      }
      if (!way.may_pass) {
        ASSERT_TRUE(error);
        EXPECT_TRUE(error->code() == ErrorCode::kTimedOut || error->code() == ErrorCode::kBadData) << error->message();
        EXPECT_FALSE(turntable && turntable->is_homed());
      }
      is_mended = true;
      if (turntable) {
        EXPECT_TRUE(goes_on(turntable.get()));
      }
    }
  }
}

TEST(SerialTurntable, waits_longer_while_it_is_busy) {
  std::atomic<int> busy = 0;
  ScriptedController controller([&](std::size_t, const std::string& line) -> std::optional<ScriptedController::Fault> {
    if (!line.starts_with("G0")) return std::nullopt;
    ++busy;
    return ScriptedController::Fault{"echo:busy: processing\necho:busy: processing\n//thinking\nok\n"};
  });
  SerialTurntableOptions options = quick(controller);
  options.answer_timeout = milliseconds(3000);
  auto turntable = SerialTurntable::open(options);
  ASSERT_TRUE(turntable);
  EXPECT_TRUE((*turntable)->home());
  EXPECT_EQ(busy, 1);
}

TEST(SerialTurntable, repeats_its_command_after_a_controllers_greeting) {
  ScriptedController controller([](std::size_t number, const std::string&) -> std::optional<ScriptedController::Fault> {
    if (number == 0) return ScriptedController::Fault{"start\necho:Marlin 2.1.2\n"};
    return std::nullopt;
  });
  SerialTurntableOptions options = quick(controller);
  options.answer_timeout = milliseconds(3000);
  EXPECT_TRUE(SerialTurntable::open(options));
}

TEST(SerialTurntable, does_not_take_a_late_ok_for_the_next_one) {
  std::atomic<bool> is_late = true;
  ScriptedController controller([&](std::size_t, const std::string& line) -> std::optional<ScriptedController::Fault> {
    if (line.starts_with("G0 X28") && is_late) return ScriptedController::Fault{std::string()};
    if (line == "M114" && is_late.exchange(false))
      return ScriptedController::Fault{"ok\nX:0.00 Y:0.00 Count X:0\nok\n"};
    return std::nullopt;
  });
  is_late = false;
  SerialTurntableOptions options = quick(controller);
  auto turntable = SerialTurntable::open(options);
  ASSERT_TRUE(turntable);
  ASSERT_TRUE((*turntable)->home());
  is_late = true;
  EXPECT_FALSE((*turntable)->turn_to(0.5));
  ASSERT_TRUE((*turntable)->home());
  ASSERT_TRUE((*turntable)->turn_to(0.25));
  EXPECT_NEAR(*(*turntable)->angle(), 0.25, 1e-3);
}

TEST(SerialTurntable, locks_its_line) {
  ScriptedController controller;
  SerialTurntableOptions options = quick(controller);
  options.answer_timeout = milliseconds(3000);
  auto first = SerialTurntable::open(options);
  ASSERT_TRUE(first);
  EXPECT_EQ(SerialTurntable::open(options).error().code(), ErrorCode::kBusy);
}

TEST(SerialTurntable, refuses_files_that_are_not_serial_lines) {
  SerialTurntableOptions options;
  options.device = "/dev/there-is-none";
  EXPECT_EQ(SerialTurntable::open(options).error().code(), ErrorCode::kNotFound);
  options.device = "/dev/null";
  EXPECT_EQ(SerialTurntable::open(options).error().code(), ErrorCode::kInvalidArgument);
  options.baud = 250001;
  EXPECT_THAT(SerialTurntable::open(options).error().message(), HasSubstr("115200"));
  options.axis = 'x';
  EXPECT_EQ(SerialTurntable::open(options).error().code(), ErrorCode::kInvalidArgument);
}

TEST(Gcode, reads_the_lines_of_common_firmwares) {
  using Kind = gcode::Answer::Kind;
  const auto kind = [](std::string_view line) { return gcode::parse_answer(line, 'X').kind; };
  EXPECT_EQ(kind("ok"), Kind::kOk);
  EXPECT_EQ(kind("ok P15 B3\r"), Kind::kOk);
  EXPECT_EQ(kind("okay"), Kind::kChatter);
  EXPECT_EQ(kind("Error:No thermistor"), Kind::kError);
  EXPECT_EQ(kind("start"), Kind::kRestart);
  EXPECT_EQ(kind("echo:busy: paused for user"), Kind::kBusy);
  EXPECT_EQ(kind("echo:  G21    ; Units in mm (mm)"), Kind::kChatter);
  EXPECT_EQ(kind("Resend: 3"), Kind::kResend);
  EXPECT_EQ(kind(""), Kind::kChatter);
  const auto position = [](std::string_view line, char axis) { return gcode::parse_answer(line, axis); };
  EXPECT_EQ(position("X:-12.50 Y:3.00 Z:0.00 E:0.00 Count X:-1000 Y:0 Z:0", 'X').position, -12.5);
  EXPECT_EQ(position("X:-12.50 Y:3.00 Z:0.00 E:0.00 Count X:-1000 Y:0 Z:0", 'Y').position, 3.0);
  EXPECT_EQ(position("X: 1.5 Y: 2.5 Count X: 9", 'Y').position, 2.5);
  EXPECT_EQ(position("Y:1.00 Count X:1000", 'X').kind, Kind::kChatter);  // Motor steps are not a position.
  EXPECT_EQ(position("X:inf", 'X').kind, Kind::kChatter);
  EXPECT_EQ(position("X:1e999 Y:0", 'X').kind, Kind::kChatter);
}

}  // namespace
}  // namespace cyclorama::turntable
