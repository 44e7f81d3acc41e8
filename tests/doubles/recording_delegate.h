// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderfarm/coordinator/delegate.h"

namespace cyclorama {

/// Records the messages of CoordinatorState by receiver. Thread-bound.
class RecordingDelegate final : public coordinator::CoordinatorDelegate {
 public:
  std::map<coordinator::NodeId, std::deque<wire::NodeCommand>> commands;
  std::map<coordinator::SessionId, std::deque<wire::SessionReply>> replies;
  std::map<coordinator::NodeId, Error> ended_nodes;
  std::map<coordinator::SessionId, Error> ended_sessions;
  std::vector<coordinator::FrameReport> frames;
  std::vector<std::string> accepted_light;  ///< Versions that nodes may send.
  std::vector<std::string> forgotten_light;
  std::vector<std::string> notices;
  std::vector<coordinator::NoticeAbout> noticed;  ///< Subject of each notice.

  void to_node(coordinator::NodeId node, const wire::NodeCommand& command) override {
    commands[node].push_back(command);
  }
  void to_museum(coordinator::SessionId session, wire::SessionReply reply) override {
    replies[session].push_back(std::move(reply));
  }
  void accept_light(const wire::LightVersion& light) override { accepted_light.push_back(light.version()); }
  void forget_light(const wire::LightVersion& light) override { forgotten_light.push_back(light.version()); }
  void end_node(coordinator::NodeId node, const Error& reason) override { ended_nodes.emplace(node, reason); }
  void end_session(coordinator::SessionId session, const Error& reason, bool at_once) override {
    if (at_once) replies.erase(session);
    ended_sessions.emplace(session, reason);
  }
  void frame_ended(const coordinator::FrameReport& report) override { frames.push_back(report); }
  void notice(const std::string& sentence, const coordinator::NoticeAbout& about) override {
    notices.push_back(sentence);
    noticed.push_back(about);
  }
};

}  // namespace cyclorama
