// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/relay_times.h"

#include <gtest/gtest.h>

namespace cyclorama::coordinator {
namespace {

using namespace std::chrono_literals;

constexpr SessionId kSession{1};
const TimePoint kStart{1h};

struct Wire {
  RelayTimes times;

  RelayTimes::Times begin(TimePoint cause, TimePoint taken) {
    wire::SessionReply reply;
    reply.mutable_begin();
    return both(reply, cause, taken);
  }
  RelayTimes::Times tile(TimePoint cause, TimePoint taken) {
    wire::SessionReply reply;
    reply.mutable_tile();
    return both(reply, cause, taken);
  }
  static wire::SessionReply end(std::uint64_t number) {
    wire::SessionReply reply;
    reply.mutable_end()->set_view_number(number);
    return reply;
  }
  static FrameReport report(std::uint64_t number) {
    FrameReport report;
    report.session = kSession;
    report.complete = true;
    report.view.set_number(number);
    report.received_at = kStart;
    report.queue_seconds = 0.002;
    report.rays_seconds = 0.030;
    return report;
  }

 private:
  RelayTimes::Times both(const wire::SessionReply& reply, TimePoint cause, TimePoint taken) {
    times.sent(kSession, cause);
    return times.taken(kSession, reply, taken);
  }
};

TEST(RelayTimes, a_tiles_relay_time_runs_from_its_cause_until_it_is_written) {
  Wire wire;
  EXPECT_FALSE(wire.begin(kStart, kStart + 5ms).relay_seconds);
  EXPECT_DOUBLE_EQ(*wire.tile(kStart + 10ms, kStart + 12ms).relay_seconds, 0.002);
  // Two tiles are under way at once, each with its own cause.
  wire.times.sent(kSession, kStart + 20ms);
  wire.times.sent(kSession, kStart + 21ms);
  wire::SessionReply tile;
  tile.mutable_tile();
  EXPECT_DOUBLE_EQ(*wire.times.taken(kSession, tile, kStart + 25ms).relay_seconds, 0.005);
  EXPECT_DOUBLE_EQ(*wire.times.taken(kSession, tile, kStart + 26ms).relay_seconds, 0.005);
}

TEST(RelayTimes, a_frames_overhead_excludes_its_queue_and_render_times) {
  Wire wire;
  wire.begin(kStart, kStart + 3ms);
  wire.tile(kStart + 33ms, kStart + 35ms);
  wire.times.sent(kSession, kStart + 33ms);
  wire.times.frame_ended(Wire::report(7));
  const auto times = wire.times.taken(kSession, Wire::end(7), kStart + 40ms);
  ASSERT_TRUE(times.overhead_seconds);
  EXPECT_NEAR(*times.overhead_seconds, 0.035 - 0.002 - 0.030, 1e-9) << "the end itself does not count";
}

TEST(RelayTimes, only_complete_frames_without_moved_blocks_count) {
  for (const auto& spoil : std::initializer_list<void (*)(FrameReport&)>{
           [](FrameReport& r) { r.complete = false; }, [](FrameReport& r) { r.refined = true; },
           [](FrameReport& r) { r.reassigned = true; }, [](FrameReport& r) { r.moved = 1; }}) {
    Wire wire;
    wire.tile(kStart, kStart + 35ms);
    wire.times.sent(kSession, kStart);
    FrameReport report = Wire::report(7);
    spoil(report);
    wire.times.frame_ended(report);
    EXPECT_FALSE(wire.times.taken(kSession, Wire::end(7), kStart + 40ms).overhead_seconds);
  }
}

TEST(RelayTimes, the_end_of_a_refinement_is_not_taken_for_the_frames_end) {
  Wire wire;
  wire.tile(kStart, kStart + 35ms);
  wire.times.sent(kSession, kStart);
  wire.times.frame_ended(Wire::report(7));
  EXPECT_TRUE(wire.times.taken(kSession, Wire::end(7), kStart + 40ms).overhead_seconds);
  wire.times.sent(kSession, kStart);
  EXPECT_FALSE(wire.times.taken(kSession, Wire::end(7), kStart + 80ms).overhead_seconds);
}

TEST(RelayTimes, an_ended_session_leaves_nothing) {
  Wire wire;
  wire.times.sent(kSession, kStart);
  wire.times.session_ended(kSession);
  wire::SessionReply tile;
  tile.mutable_tile();
  EXPECT_FALSE(wire.times.taken(kSession, tile, kStart + 1ms).relay_seconds);
}

}  // namespace
}  // namespace cyclorama::coordinator
