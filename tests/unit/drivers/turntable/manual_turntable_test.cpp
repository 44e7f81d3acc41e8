// SPDX-License-Identifier: Apache-2.0
#include "drivers/turntable/manual/manual_turntable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>

#include "common/base/unique_fd.h"

namespace cyclorama::turntable {
namespace {

using ::testing::HasSubstr;
constexpr double kDegree = std::numbers::pi / 180.0;

/// A terminal that consists of two pipes.
class Terminal {
 public:
  Terminal() {
    std::array<int, 2> in{};
    std::array<int, 2> out{};
    CHECK(::pipe(in.data()) == 0 && ::pipe(out.data()) == 0);
    read_in_.reset(in[0]);
    write_in_.reset(in[1]);
    read_out_.reset(out[0]);
    write_out_.reset(out[1]);
  }
  void type(std::string_view text) {
    ASSERT_EQ(::write(write_in_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void close() { write_in_.reset(); }
  std::string shown() {
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(read_out_.get(), bytes.data(), bytes.size());
    return {bytes.data(), static_cast<std::size_t>(count)};
  }
  std::unique_ptr<TurntableOperator> somebody() {
    return std::make_unique<TerminalOperator>(read_in_.get(), write_out_.get());
  }

 private:
  UniqueFd read_in_, write_in_, read_out_, write_out_;
};

TEST(ManualTurntable, asks_for_the_angle_and_accepts_an_enter) {
  Terminal terminal;
  ManualTurntable turntable(terminal.somebody());
  terminal.type("\n\n\r\n");
  ASSERT_TRUE(turntable.home());
  EXPECT_THAT(terminal.shown(), HasSubstr("0 degrees"));
  ASSERT_TRUE(turntable.turn_to(30.0 * kDegree));
  EXPECT_THAT(terminal.shown(), HasSubstr("30.0 degrees to the right"));
  ASSERT_TRUE(turntable.turn_to(-45.0 * kDegree));
  EXPECT_THAT(terminal.shown(), HasSubstr("45.0 degrees to the left"));
  EXPECT_NEAR(*turntable.angle(), -45.0 * kDegree, 1e-12);
}

TEST(ManualTurntable, uses_the_operators_own_reading) {
  Terminal terminal;
  ManualTurntable turntable(terminal.somebody());
  terminal.type("\nabout there\n999\n29.5\n");
  ASSERT_TRUE(turntable.home());
  ASSERT_TRUE(turntable.turn_to(30.0 * kDegree));
  EXPECT_NEAR(*turntable.angle(), 29.5 * kDegree, 1e-12);
  EXPECT_THAT(terminal.shown(), HasSubstr("'about there' is no angle"));
}

TEST(ManualTurntable, ends_when_the_operator_leaves) {
  Terminal terminal;
  ManualTurntable turntable(terminal.somebody());
  terminal.type("q\n");
  EXPECT_EQ(turntable.home().error().code(), ErrorCode::kUnavailable);
  Terminal closed;
  ManualTurntable alone(closed.somebody());
  closed.close();
  EXPECT_EQ(alone.home().error().code(), ErrorCode::kUnavailable);
}

TEST(ManualTurntable, reports_a_stall_when_the_operator_does_not_answer) {
  Terminal terminal;
  ManualTurntable turntable(terminal.somebody(), {-1.0, 1.0}, std::chrono::milliseconds(20));
  terminal.type("\nhalf a li");
  ASSERT_TRUE(turntable.home());
  EXPECT_EQ(turntable.turn_to(0.5).error().code(), ErrorCode::kTimedOut);
  EXPECT_FALSE(turntable.is_homed());
}

}  // namespace
}  // namespace cyclorama::turntable
