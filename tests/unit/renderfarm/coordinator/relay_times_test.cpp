// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/relay_times.h"

#include <gtest/gtest.h>

namespace cyclorama::coordinator {
namespace {

using namespace std::chrono_literals;

constexpr SessionId kVisit{1};
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
    report.session = kVisit;
    report.complete = true;
    report.view.set_number(number);
    report.received_at = kStart;
    report.queue_seconds = 0.002;
    report.rays_seconds = 0.030;
    return report;
  }

 private:
  RelayTimes::Times both(const wire::SessionReply& reply, TimePoint cause, TimePoint taken) {
    times.sent(kVisit, cause);
    return times.taken(kVisit, reply, taken);
  }
};

TEST(RelayTimes, a_tile_takes_from_its_cause_until_it_is_written) {
  Wire wire;
  EXPECT_FALSE(wire.begin(kStart, kStart + 5ms).relay_seconds);
  EXPECT_DOUBLE_EQ(*wire.tile(kStart + 10ms, kStart + 12ms).relay_seconds, 0.002);
  // Two tiles are under way at once, each with its own cause.
  wire.times.sent(kVisit, kStart + 20ms);
  wire.times.sent(kVisit, kStart + 21ms);
  wire::SessionReply tile;
  tile.mutable_tile();
  EXPECT_DOUBLE_EQ(*wire.times.taken(kVisit, tile, kStart + 25ms).relay_seconds, 0.005);
  EXPECT_DOUBLE_EQ(*wire.times.taken(kVisit, tile, kStart + 26ms).relay_seconds, 0.005);
}

TEST(RelayTimes, a_frames_overhead_is_all_but_its_turn_and_its_rays) {
  Wire wire;
  wire.begin(kStart, kStart + 3ms);
  wire.tile(kStart + 33ms, kStart + 35ms);
  wire.times.sent(kVisit, kStart + 33ms);
  wire.times.frame_ended(Wire::report(7));
  const auto times = wire.times.taken(kVisit, Wire::end(7), kStart + 40ms);
  ASSERT_TRUE(times.overhead_seconds);
  EXPECT_NEAR(*times.overhead_seconds, 0.035 - 0.002 - 0.030, 1e-9) << "the end itself does not count";
}

TEST(RelayTimes, only_whole_frames_whose_blocks_stayed_where_they_were_count) {
  for (const auto& spoil : std::initializer_list<void (*)(FrameReport&)>{
           [](FrameReport& r) { r.complete = false; }, [](FrameReport& r) { r.refined = true; },
           [](FrameReport& r) { r.reassigned = true; }, [](FrameReport& r) { r.moved = 1; }}) {
    Wire wire;
    wire.tile(kStart, kStart + 35ms);
    wire.times.sent(kVisit, kStart);
    FrameReport report = Wire::report(7);
    spoil(report);
    wire.times.frame_ended(report);
    EXPECT_FALSE(wire.times.taken(kVisit, Wire::end(7), kStart + 40ms).overhead_seconds);
  }
}

TEST(RelayTimes, a_refined_end_of_the_same_view_is_not_taken_for_the_first) {
  Wire wire;
  wire.tile(kStart, kStart + 35ms);
  wire.times.sent(kVisit, kStart);
  wire.times.frame_ended(Wire::report(7));
  EXPECT_TRUE(wire.times.taken(kVisit, Wire::end(7), kStart + 40ms).overhead_seconds);
  wire.times.sent(kVisit, kStart);
  EXPECT_FALSE(wire.times.taken(kVisit, Wire::end(7), kStart + 80ms).overhead_seconds);
}

TEST(RelayTimes, a_session_that_has_ended_leaves_nothing) {
  Wire wire;
  wire.times.sent(kVisit, kStart);
  wire.times.session_ended(kVisit);
  wire::SessionReply tile;
  tile.mutable_tile();
  EXPECT_FALSE(wire.times.taken(kVisit, tile, kStart + 1ms).relay_seconds);
}

}  // namespace
}  // namespace cyclorama::coordinator
