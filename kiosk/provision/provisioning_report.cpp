// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/provisioning_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/text.h"
#include "kiosk/provision/sentences.h"

namespace cyclorama::provision {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxReportBytes = 256 * 1024;
constexpr std::array<std::pair<ProvisioningVerdict, std::string_view>, 5> kVerdicts{
    {{ProvisioningVerdict::kInstalled, "installed"},
     {ProvisioningVerdict::kUnchanged, "unchanged"},
     {ProvisioningVerdict::kRefused, "refused"},
     {ProvisioningVerdict::kRestored, "restored"},
     {ProvisioningVerdict::kUnconfirmed, "unconfirmed"}}};

}  // namespace

std::string_view to_text(ProvisioningVerdict verdict) {
  for (const auto& [known, text] : kVerdicts) {
    if (known == verdict) return text;
  }
  return "?";
}

std::string report_json(const ProvisioningReport& report) {
  const Json json{{"at", report.at},
                  {"source", printable(report.source, 500)},
                  {"verdict", to_text(report.verdict)},
                  {"in_use", report.in_use},
                  {"museum", printable(report.museum, 200)},
                  {"farm", bounded_sentences(report.farm)},
                  {"projectors", report.projectors},
                  {"certificate_until", report.certificate_until},
                  {"has_pin", report.has_pin},
                  {"digest", report.digest},
                  {"problems", bounded_sentences(report.problems)},
                  {"remarks", bounded_sentences(report.remarks)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<ProvisioningReport> parse_report(std::string_view text) {
  const Error bad(ErrorCode::kBadData, "is no report of cyclorama-provision; plug the stick in again");
  if (text.size() > kMaxReportBytes) return bad;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return bad;
  ProvisioningReport report;
  std::string verdict;
  const auto projectors = json.find("projectors");
  const auto pin = json.find("has_pin");
  if (!read_sentence(json, "at", &report.at) || !read_sentence(json, "source", &report.source) ||
      !read_sentence(json, "verdict", &verdict) || !read_sentence(json, "in_use", &report.in_use) ||
      !read_sentence(json, "museum", &report.museum) ||
      !read_sentence(json, "certificate_until", &report.certificate_until) ||
      !read_sentences(json, "farm", &report.farm) || !read_sentences(json, "problems", &report.problems) ||
      !read_sentences(json, "remarks", &report.remarks) || projectors == json.end() ||
      !projectors->is_number_unsigned() || projectors->get<std::uint64_t>() > 1000 || pin == json.end() ||
      !pin->is_boolean()) {
    return bad;
  }
  // Reports of earlier versions have none.
  if (json.contains("digest") && !read_sentence(json, "digest", &report.digest)) return bad;
  if (!report.digest.empty() && !is_digest(report.digest)) return bad;
  report.projectors = projectors->get<int>();
  report.has_pin = pin->get<bool>();
  const auto known =
      std::find_if(kVerdicts.begin(), kVerdicts.end(), [&](const auto& v) { return v.second == verdict; });
  if (known == kVerdicts.end()) return bad;
  report.verdict = known->first;
  return report;
}

bool is_digest(std::string_view text) {
  constexpr std::size_t kDigits = 64;
  return text.size() == kDigits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string time_text(std::time_t time) {
  std::tm parts{};
  if (::gmtime_r(&time, &parts) == nullptr) return "";
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                     parts.tm_hour, parts.tm_min, parts.tm_sec);
}

}  // namespace cyclorama::provision
