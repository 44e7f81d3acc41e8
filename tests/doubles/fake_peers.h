// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderfarm/coordinator/peers.h"

namespace cyclorama {

/// Keeps what HeadState says to whom. Thread-bound.
class FakePeers final : public Peers {
 public:
  std::map<NodeId, std::deque<wire::NodeCommand>> commands;
  std::map<SessionId, std::deque<wire::VisitReply>> replies;
  std::map<NodeId, Error> ended_nodes;
  std::map<SessionId, Error> ended_visits;
  std::vector<FrameReport> frames;
  std::vector<std::string> notices;
  std::vector<NoticeAbout> noticed;  ///< Whom each of them is about.

  void to_node(NodeId node, const wire::NodeCommand& command) override { commands[node].push_back(command); }
  void to_museum(SessionId session, wire::VisitReply reply) override { replies[session].push_back(std::move(reply)); }
  void end_node(NodeId node, const Error& reason) override { ended_nodes.emplace(node, reason); }
  void end_visit(SessionId session, const Error& reason, bool at_once) override {
    if (at_once) replies.erase(session);
    ended_visits.emplace(session, reason);
  }
  void frame_ended(const FrameReport& report) override { frames.push_back(report); }
  void notice(const std::string& sentence, const NoticeAbout& about) override {
    notices.push_back(sentence);
    noticed.push_back(about);
  }
};

/// Stands still until it is moved.
class FakeClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return now_; }
  void advance(Duration by) { now_ += by; }

 private:
  TimePoint now_ = TimePoint(std::chrono::hours(1));
};

}  // namespace cyclorama
