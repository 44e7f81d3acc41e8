// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/museum_routes.h"

#include <absl/time/time.h>
#include <fmt/format.h>
#include <httplib.h>

#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/http/http_server.h"
#include "kiosk/operator/network_test.h"
#include "kiosk/operator/page_language.h"
#include "kiosk/operator/status_json.h"
#include "kiosk/provision/provisioning_report.h"

namespace cyclorama::operations {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxRecoveryKeyBytes = 1000;
constexpr std::size_t kMaxShownEvents = 20;
constexpr std::size_t kMaxShownDays = 30;

/// Allows one expensive operation at a time.
class Turn {
 public:
  explicit Turn(std::atomic<bool>* taken) : taken_(*taken), is_ours_(!taken_.exchange(true)) {}
  ~Turn() {
    if (is_ours_) taken_ = false;
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  [[nodiscard]] bool is_ours() const { return is_ours_; }

 private:
  std::atomic<bool>& taken_;
  const bool is_ours_;
};

std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

Json schedule_json(const MuseumState& museum, std::chrono::system_clock::time_point now) {
  const OpeningSchedule schedule = schedule_of(museum, now);
  Json json{{"open", schedule.is_open}, {"lines", schedule.lines}, {"problem", schedule.problem},
            {"zone", schedule.zone},    {"override", nullptr},     {"override_problem", schedule.override_problem}};
  if (schedule.override) {
    json["override"] = {{"open", schedule.override->is_open},
                        {"until", absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", absl::FromChrono(schedule.override->until),
                                                   absl::UTCTimeZone())},
                        {"is_today", schedule.is_until_today}};
  }
  return json;
}

bool has_recovery_key(const MuseumServices& services) {
  std::error_code ignored;
  return !services.recovery_key.empty() && std::filesystem::exists(services.recovery_key, ignored);
}

Json alarms_json(const AlarmService::Report& report) {
  return {{"mail", report.has_mail},
          {"webhook", report.has_webhook},
          {"quiet", report.quiet},
          {"delivered_at", report.delivered_at},
          {"problem", report.problem}};
}

std::string utc_text(care::WallSeconds time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", absl::FromChrono(time), absl::UTCTimeZone());
}

/// Adds the last faults, the newest first, and the counts of the last days with visits.
void add_records(const CareLog::Report& report, Json* json) {
  Json history = Json::array();
  for (auto event = report.events.rbegin(); event != report.events.rend(); ++event) {
    if (history.size() == kMaxShownEvents) break;
    history.push_back({{"title", event->fault.title},
                       {"sentence", event->fault.sentence},
                       {"remedy", event->fault.remedy},
                       {"at", utc_text(event->is_over ? event->at : event->since)},
                       {"is_over", event->is_over}});
  }
  Json days = Json::array();
  for (auto day = report.days.rbegin(); day != report.days.rend(); ++day) {
    if (days.size() == kMaxShownDays) break;
    days.push_back({{"date", day->first}, {"visits", day->second.visits}, {"seconds", day->second.seconds}});
  }
  (*json)["history"] = std::move(history);
  (*json)["visits"] = {{"today", report.today}, {"is_visited", report.is_visited}, {"days", std::move(days)}};
}

std::string museum_json(const MuseumServices& services) {
  const MuseumState& museum = services.support.museum;
  const Findings findings = findings_of(services.watch->observations(), museum);
  std::vector<Check> checks = checks_of(findings);
  if (services.alarms != nullptr) {
    if (auto check = services.alarms->check()) checks.push_back(*std::move(check));
  }
  Json json{{"level", to_text(worst_of(checks))},
            {"checks", Json::parse(checks_json(checks))},
            {"schedule", nullptr},
            {"provisioning", nullptr},
            {"update", nullptr},
            {"alarms", nullptr},
            {"history", nullptr},
            {"visits", nullptr},
            {"calibration", nullptr},
            {"watched", nullptr},
            {"page",
             {{"version", CYCLORAMA_VERSION},
              {"fingerprint", services.fingerprint},
              {"time", provision::time_text(std::chrono::system_clock::to_time_t(findings.now))},
              {"requests", !services.requests.empty()},
              {"recovery", has_recovery_key(services)},
              {"has_pin", !services.fingerprint.empty()}}}};
  if (findings.is_museum) json["schedule"] = schedule_json(museum, findings.now);
  if (findings.provisioning) json["provisioning"] = Json::parse(provision::report_json(*findings.provisioning));
  if (findings.update) {
    json["update"] = {{"state", to_text(findings.update->state)},
                      {"version", findings.update->version},
                      {"available", findings.update->available},
                      {"at", findings.update->at}};
  }
  if (services.alarms != nullptr) json["alarms"] = alarms_json(services.alarms->report());
  if (services.log != nullptr) add_records(services.log->report(), &json);
  if (services.calibration != nullptr) json["calibration"] = Json::parse(services.calibration->json());
  if (services.healing != nullptr) json["watched"] = Json::parse(services.healing->json());
  return dumped(json);
}

void serve_calibration(httplib::Server& server, MuseumServices* services) {
  server.Get("/calibration.jpg", [services](const httplib::Request&, httplib::Response& response) {
    const std::string jpeg = services->calibration == nullptr ? "" : services->calibration->picture();
    if (jpeg.empty()) return answer_error(Error(ErrorCode::kNotFound, "there is no picture yet"), response);
    response.set_content(jpeg, "image/jpeg");
  });
  server.Post("/calibration", [services](const httplib::Request& request, httplib::Response& response) {
    const auto wanted = parse_calibration_request(request.body);
    if (!wanted) return answer_error(wanted.error(), response);
    if (services->calibration == nullptr) {
      return answer_error(
          Error(ErrorCode::kNotFound, "no calibrator is named; start the page with --calibrator ADDRESS"), response);
    }
    response.status = 204;
    switch (wanted->kind) {
      case CalibrationRequest::Kind::kStart:
        if (const Status started = services->calibration->start(wanted->order); !started)
          answer_error(started.error(), response);
        return;
      case CalibrationRequest::Kind::kPlaceCameras:
        if (const Status started = services->calibration->place_cameras(); !started)
          answer_error(started.error(), response);
        return;
      case CalibrationRequest::Kind::kAnswer:
        if (const Status answered = services->calibration->answer(wanted->text); !answered)
          answer_error(answered.error(), response);
        return;
      case CalibrationRequest::Kind::kCancel:
        return services->calibration->cancel();
      case CalibrationRequest::Kind::kRestore:
        const auto date = services->calibration->restore();
        if (!date) return answer_error(date.error(), response);
        response.status = 200;
        response.set_content(dumped({{"date", *date}}), kJsonType);
    }
  });
}

void serve_healing(httplib::Server& server, MuseumServices* services) {
  server.Post("/realign", [services](const httplib::Request&, httplib::Response& response) {
    if (services->healing == nullptr) {
      return answer_error(
          Error(ErrorCode::kNotFound, "no calibrator is named; start the page with --calibrator ADDRESS"), response);
    }
    if (const Status told = services->healing->realign(); !told) return answer_error(told.error(), response);
    response.status = 204;
  });
  server.Post("/realign/undo", [services](const httplib::Request& request, httplib::Response& response) {
    if (services->healing == nullptr) {
      return answer_error(
          Error(ErrorCode::kNotFound, "no calibrator is named; start the page with --calibrator ADDRESS"), response);
    }
    const auto undone = services->healing->undo();
    if (!undone) return answer_error(undone.error(), response);
    answer_json(request, dumped({{"undone", *undone}}), response);
  });
}

void serve_support(httplib::Server& server, MuseumServices* services) {
  server.Post("/network-test", [services](const httplib::Request& request, httplib::Response& response) {
    const Turn turn(&services->is_testing);
    if (!turn.is_ours()) return answer_error(Error(ErrorCode::kBusy, "a network test runs already"), response);
    const MuseumState& museum = services->support.museum;
    const auto checks = test_network(farm_of(museum), read_machine_facts(museum.root));
    answer_json(request, dumped({{"checks", Json::parse(checks_json(checks))}}), response);
  });
  server.Get("/support-bundle.zip", [services](const httplib::Request&, httplib::Response& response) {
    const Turn turn(&services->is_bundling);
    if (!turn.is_ours()) return answer_error(Error(ErrorCode::kBusy, "a bundle is being made already"), response);
    const auto bundle =
        support_bundle(services->support, status_json(services->watch->observations()), museum_json(*services));
    if (!bundle) return answer_error(bundle.error(), response);
    response.set_header("Content-Disposition", "attachment; filename=\"cyclorama-support.zip\"");
    response.set_content(*bundle, "application/zip");
  });
}

void serve_hours(httplib::Server& server, MuseumServices* services) {
  server.Post("/hours", [services](const httplib::Request& request, httplib::Response& response) {
    const auto wanted = parse_hours_request(request.body);
    if (!wanted) return answer_error(wanted.error(), response);
    const Status set = set_hours(services->support.museum, *wanted, std::chrono::system_clock::now());
    if (!set) return answer_error(set.error(), response);
    response.status = 204;
  });
}

void serve_alarms(httplib::Server& server, MuseumServices* services) {
  server.Post("/alarm-test", [services](const httplib::Request&, httplib::Response& response) {
    if (services->alarms == nullptr) {
      return answer_error(Error(ErrorCode::kNotFound, "this page sends no alarms; start it with --keep FOLDER"),
                          response);
    }
    const Turn turn(&services->is_sending);
    if (!turn.is_ours()) return answer_error(Error(ErrorCode::kBusy, "a test is being sent already"), response);
    if (const Status sent = services->alarms->send_test(); !sent) return answer_error(sent.error(), response);
    response.status = 204;
  });
}

void serve_requests(httplib::Server& server, MuseumServices* services) {
  server.Post("/request", [services](const httplib::Request& request, httplib::Response& response) {
    const Json json = Json::parse(request.body, nullptr, false);
    const std::string wanted = json.is_object() && json.contains("request") && json["request"].is_string()
                                   ? json["request"].get<std::string>()
                                   : "";
    if (wanted != "update" && wanted != "factory-reset" && wanted != "confirm-stick") {
      return answer_error(Error(ErrorCode::kBadData, "'request' must be update, factory-reset or confirm-stick"),
                          response);
    }
    // The digest that the page showed: another stick may have been plugged in since then.
    const std::string digest =
        json.contains("digest") && json["digest"].is_string() ? json["digest"].get<std::string>() : "";
    if ((wanted == "confirm-stick") != provision::is_digest(digest)) {
      return answer_error(Error(ErrorCode::kBadData, "'digest' must be the stick's, with confirm-stick alone"),
                          response);
    }
    if (services->requests.empty()) {
      return answer_error(Error(ErrorCode::kNotFound, "this computer's software is not managed by the museum image"),
                          response);
    }
    const Status made = write_file_atomically(services->requests / wanted, digest + "\n");
    if (!made) return answer_error(made.error(), response);
    response.status = 204;
  });
}

/// Shows the recovery key once: from then on it is only where somebody wrote it down.
void serve_recovery_key(httplib::Server& server, MuseumServices* services) {
  server.Post("/recovery-key", [services](const httplib::Request&, httplib::Response& response) {
    const auto key = has_recovery_key(*services)
                         ? read_text_file(services->recovery_key, kMaxRecoveryKeyBytes)
                         : Result<std::string>(Error(ErrorCode::kNotFound, "the recovery key was shown already"));
    if (!key) return answer_error(key.error(), response);
    std::error_code failed;
    if (!std::filesystem::remove(services->recovery_key, failed)) {
      return answer_error(Error(ErrorCode::kSystem, "the recovery key cannot be removed, so it is not shown"),
                          response);
    }
    response.set_content(dumped({{"key", key->substr(0, key->find('\n'))}}), kJsonType);
  });
}

}  // namespace

Result<HoursRequest> parse_hours_request(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  const auto text = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
  };
  const std::string kind = text("do");
  if (kind == "open") return HoursRequest{HoursRequest::Kind::kOpen, text("until")};
  if (kind == "closed") return HoursRequest{HoursRequest::Kind::kClosed};
  if (kind == "settings") return HoursRequest{HoursRequest::Kind::kSettings};
  return Error(ErrorCode::kBadData, "'do' must be open, with 'until', or closed or settings");
}

void serve_museum(httplib::Server& server, MuseumServices* services) {
  server.Get("/museum", [services](const httplib::Request& request, httplib::Response& response) {
    answer_json(request, museum_json(*services), response);
  });
  serve_calibration(server, services);
  serve_healing(server, services);
  serve_support(server, services);
  serve_hours(server, services);
  serve_alarms(server, services);
  serve_requests(server, services);
  serve_recovery_key(server, services);
}

}  // namespace cyclorama::operations
