// SPDX-License-Identifier: Apache-2.0
#include "kiosk/update/update_status.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::update {
namespace {

using Json = nlohmann::json;
using State = UpdateStatus::State;

constexpr std::size_t kMaxStatusBytes = 64 * 1024;
constexpr std::array<std::pair<State, std::string_view>, 6> kStates{{{State::kCurrent, "current"},
                                                                     {State::kChecking, "checking"},
                                                                     {State::kLoading, "loading"},
                                                                     {State::kReady, "ready"},
                                                                     {State::kFailed, "failed"},
                                                                     {State::kRolledBack, "rolled-back"}}};

std::string text_of(const Json& json, const char* key, std::size_t limit) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? printable(found->get_ref<const std::string&>(), limit) : "";
}

}  // namespace

std::string_view to_text(State state) {
  for (const auto& [known, text] : kStates) {
    if (known == state) return text;
  }
  return "?";
}

Result<UpdateStatus> parse_update_status(std::string_view text) {
  const Error bad(ErrorCode::kBadData, "is no update status");
  const Json json = text.size() <= kMaxStatusBytes ? Json::parse(text, nullptr, false) : Json();
  if (!json.is_object()) return bad;
  UpdateStatus status;
  const std::string state = text_of(json, "state", 40);
  const auto known = std::find_if(kStates.begin(), kStates.end(), [&](const auto& s) { return s.second == state; });
  status.version = text_of(json, "version", 100);
  if (known == kStates.end() || status.version.empty()) return bad;
  status.state = known->first;
  status.available = text_of(json, "available", 100);
  status.at = text_of(json, "at", 40);
  status.sentence = text_of(json, "sentence", 500);
  return status;
}

}  // namespace cyclorama::update
