// SPDX-License-Identifier: Apache-2.0
#include "common/reach/page_reach.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/json/strict_json.h"

namespace cyclorama {
namespace {

constexpr int kVersion = 1;
constexpr const char* kRemedy = "restart cyclorama-operator, which writes it";
constexpr std::size_t kMaxText = 300;
constexpr std::size_t kMaxAddresses = 32;
constexpr double kMaxTime_s = 1e9;

}  // namespace

std::string to_json(const PageReach& reach) {
  return nlohmann::ordered_json{{"version", kVersion},
                                {"name", reach.name},
                                {"programs", reach.version},
                                {"language", reach.language},
                                {"addresses", reach.addresses},
                                {"fingerprint", reach.fingerprint},
                                {"wall_code", reach.wall_code},
                                {"has_pin", reach.has_pin},
                                {"answered_s", to_seconds(reach.answered_at.time_since_epoch())}}
             .dump(1, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

Result<PageReach> parse_page_reach(std::string_view text, const std::string& name) {
  TRY_ASSIGN(const nlohmann::json document, parse_document(text, name, kRemedy));
  StrictJson::Mistakes mistakes(kRemedy);
  StrictJson root(document, &mistakes);
  root.require_version(kVersion);
  PageReach reach;
  reach.name = root.text("name", kMaxText);
  reach.version = root.text("programs", kMaxText);
  reach.language = root.text("language", kMaxText);
  for (const StrictJson& address : root.list("addresses", 0, kMaxAddresses)) {
    reach.addresses.push_back(address.as_text(kMaxText));
  }
  reach.fingerprint = root.text("fingerprint", kMaxText);
  reach.wall_code = root.text("wall_code", kMaxText);
  reach.has_pin = root.flag("has_pin");
  reach.answered_at = TimePoint(
      std::chrono::duration_cast<Duration>(std::chrono::duration<double>(root.number("answered_s", 0.0, kMaxTime_s))));
  root.refuse_other_keys();
  TRY(mistakes.status(name));
  return reach;
}

std::string link_of(const PageReach& reach) {
  if (reach.addresses.empty()) return "";
  std::string link = reach.addresses.front();
  if (reach.fingerprint.empty()) return link;
  std::string fingerprint;
  for (const char c : reach.fingerprint) {
    if (c != ':') fingerprint += c;
  }
  link += "login.html#sha256=" + fingerprint;
  return reach.wall_code.empty() ? link : fmt::format("{}&wall={}", link, reach.wall_code);
}

}  // namespace cyclorama
