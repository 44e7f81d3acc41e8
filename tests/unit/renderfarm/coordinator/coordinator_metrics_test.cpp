// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_metrics.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "renderfarm/watch/status_json.h"
#include "tests/support/farm_simulation.h"
#include "tests/support/prometheus_text.h"

namespace cyclorama::coordinator {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

struct Meters {
  FarmSimulation farm;
  InspectionService inspection{"coordinator"};
  watch::FarmMetrics metrics;
  CoordinatorMetrics meters{inspection, metrics};

  /// Adds all frames that the simulation has ended since the last call.
  void read() {
    for (; read_ < farm.delegate.frames.size(); ++read_) meters.add(farm.delegate.frames[read_]);
    meters.update(farm.state, farm.clock.now());
  }
  Json status() { return Json::parse(watch::status_json(inspection.status())); }

 private:
  std::size_t read_ = 0;
};

TEST(CoordinatorMetrics, show_each_session_and_each_node_separately) {
  Meters m;
  const std::vector<NodeId> nodes{m.farm.add_node(1), m.farm.add_node(1)};
  const SessionId governed = m.farm.add_session(40.0);
  const SessionId free = m.farm.add_session();
  m.farm.settle(nodes);
  m.read();
  for (const SessionId session : {governed, free}) m.farm.request_view(session, view_of(1));
  m.farm.settle(nodes);
  m.farm.request_view(free, view_of(2));
  m.farm.settle(nodes);
  m.farm.clock.advance(2s);
  m.read();
  const Json status = m.status();
  ASSERT_EQ(status["sessions"].size(), 2u);
  EXPECT_EQ(status["sessions"][0]["id"], static_cast<std::uint64_t>(governed));
  EXPECT_EQ(status["sessions"][0]["budget_ms"], 40.0);
  EXPECT_EQ(status["sessions"][1]["budget_ms"], 0.0);
  EXPECT_EQ(status["sessions"][1]["frames"], 2);
  EXPECT_EQ(status["sessions"][1]["frames_per_second"], 1.0);
  EXPECT_EQ(status["sessions"][1]["samples_per_pixel"], 1);
  EXPECT_EQ(status["sessions"][1]["width_px"], 1024);
  ASSERT_EQ(status["nodes"].size(), 2u);
  EXPECT_EQ(status["nodes"][0]["state"], "ready");
  EXPECT_GT(status["nodes"][0]["load_share"], 0.5);
  EXPECT_EQ(status["nodes"][0]["scenes"], "grotto");
  EXPECT_EQ(status["gauges"]["frames"], 3);
  EXPECT_EQ(status["gauges"]["frames_per_second"], 1.5);
  EXPECT_EQ(status["stages"]["plan"]["count"], 3);
  EXPECT_EQ(samples_of(m.metrics.text()).at("cyclorama_frames_total{museum=\"museum\"}"), 3);
}

TEST(CoordinatorMetrics, forget_sessions_and_nodes_that_left) {
  Meters m;
  const NodeId node = m.farm.add_node();
  const SessionId session = m.farm.add_session();
  m.farm.settle({node});
  m.farm.request_view(session, view_of(1));
  m.farm.settle({node});
  m.read();
  m.farm.state.session_disconnected(session);
  m.farm.kill(node);
  m.farm.clock.advance(1s);
  m.read();
  const Json status = m.status();
  EXPECT_TRUE(status["sessions"].empty());
  EXPECT_TRUE(status["nodes"].empty());
  EXPECT_EQ(status["healthy"], false);
  EXPECT_EQ(status["gauges"]["frames"], 1) << "what was done stays done";
}

TEST(CoordinatorMetrics, show_what_nodes_report) {
  Meters m;
  const NodeId node = m.farm.add_node(4);
  wire::NodeReport report;
  report.mutable_status()->set_memory_bytes(1 << 20);
  report.mutable_status()->set_blocks_waiting(3);
  report.mutable_status()->set_uptime_s(60.0);
  report.mutable_status()->set_draining(true);
  m.farm.state.node_reported(node, report);
  m.read();
  const Json row = m.status()["nodes"][0];
  EXPECT_EQ(row["name"], "node 1");
  EXPECT_EQ(row["threads"], 4);
  EXPECT_EQ(row["state"], "stops");
  EXPECT_EQ(row["memory_bytes"], 1 << 20);
  EXPECT_EQ(row["blocks_waiting"], 3);
}

TEST(CoordinatorMetrics, time_a_plan_until_its_last_command_is_written) {
  Meters m;
  const std::vector<NodeId> nodes{m.farm.add_node(), m.farm.add_node()};
  const SessionId session = m.farm.add_session();
  m.farm.settle(nodes);
  m.farm.request_view(session, view_of(1));
  int order = 0;
  for (const NodeId node : nodes) {
    for (const wire::NodeCommand& command : m.farm.delegate.commands.at(node)) {
      if (command.has_render()) {
        m.farm.state.order_written(node, command.render().block(), m.farm.clock.now() + ++order * 1ms);
      }
    }
  }
  m.farm.state.order_written(nodes[0], 999, m.farm.clock.now() + 1h);  // An unknown block.
  m.farm.clock.advance(10ms);
  m.farm.settle(nodes);
  ASSERT_EQ(m.farm.delegate.frames.size(), 1u);
  const FrameReport& report = m.farm.delegate.frames.front();
  EXPECT_DOUBLE_EQ(report.fan_out_seconds, 0.001 * order);
  EXPECT_EQ(report.plan_seconds, 0.0) << "the clock stood still";
  EXPECT_EQ(report.museum, "museum");
  std::vector<std::string> stages;
  for (const wire::StageTime& stage : m.farm.last_end.stages()) stages.push_back(stage.name());
  EXPECT_EQ(stages, (std::vector<std::string>{"queue", "plan", "fan_out", "render", "encode", "farm"}));
}

TEST(Notices, name_their_subject) {
  FarmSimulation farm;
  const NodeId node = farm.add_node();
  const SessionId session = farm.add_session();
  farm.kill(node);
  farm.state.session_disconnected(session);
  std::map<std::string, NoticeAbout> about;
  for (std::size_t i = 0; i < farm.delegate.notices.size(); ++i)
    about[farm.delegate.notices[i]] = farm.delegate.noticed[i];
  EXPECT_EQ(about.at("node 'node 1' came, with 1 threads").node, "node 1");
  EXPECT_FALSE(about.at("node 'node 1' came, with 1 threads").is_trouble);
  EXPECT_TRUE(about.at("node 'node 1' is gone; 0 left").is_trouble);
  EXPECT_EQ(about.at("'museum' opened scene 'grotto'").museum, "museum");
  EXPECT_EQ(about.at("'museum' opened scene 'grotto'").session, session);
  EXPECT_EQ(about.at("'museum' left").node, "");
}

}  // namespace
}  // namespace cyclorama::coordinator
