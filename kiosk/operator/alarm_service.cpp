// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/alarm_service.h"

#include <absl/time/time.h>
#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/opening/opening_hours.h"
#include "common/process/log.h"
#include "kiosk/care/alarm_delivery.h"
#include "kiosk/care/alarm_message.h"

namespace cyclorama::operations {
namespace {

using care::Alarm;
using care::AlarmChannel;
using care::CareSettings;
using care::WallSeconds;

constexpr auto kBetweenLooks = std::chrono::seconds(5);
constexpr std::size_t kMaxStateBytes = 1 << 20;
constexpr const char* kRegistryFile = "alarms.json";
constexpr const char* kOutboxFile = "alarms-waiting.json";

WallSeconds now_of_clock() { return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()); }

std::string time_text(WallSeconds time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", absl::FromChrono(time), absl::UTCTimeZone());
}

bool is_quiet(const care::AlarmSettings& alarms, const MuseumState& museum, WallSeconds now) {
  if (!alarms.quiet) return false;
  const auto hours = read_opening_hours(museum.site());
  const absl::TimeZone zone = hours ? hours->zone() : absl::LocalTimeZone();
  const absl::CivilMinute minute = absl::ToCivilMinute(absl::FromChrono(now), zone);
  return alarms.quiet->contains(60 * minute.hour() + minute.minute());
}

std::vector<care::Fault> faults_in(const std::vector<Check>& checks, bool with_warnings) {
  std::vector<care::Fault> faults;
  for (const Check& check : checks) {
    // Its own trouble cannot be reported by the way that is in trouble.
    if (check.level == CheckLevel::kOk || check.id == "alarms") continue;
    if (check.level == CheckLevel::kWarning && !with_warnings) continue;
    faults.push_back({check.id, check.title, check.sentence, check.remedy});
  }
  return faults;
}

bool has_channel(const care::AlarmSettings& alarms, AlarmChannel channel) {
  return channel == AlarmChannel::kMail ? alarms.mail.has_value() : alarms.webhook.has_value();
}

}  // namespace

AlarmService::AlarmService(Options options) : options_(std::move(options)) {
  read_state();
  thread_ = std::thread([this] { run(); });
}

AlarmService::~AlarmService() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void AlarmService::run() {
  for (;;) {
    look(now_of_clock());
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, kBetweenLooks, [this] { return is_stopping_; })) return;
  }
}

void AlarmService::look(WallSeconds now) {
  const auto settings = care::read_care_settings(options_.museum.care());
  if (!settings || !is_clock_set(now)) return;  // The settings' fault is the provisioning's to report.
  {
    const std::lock_guard lock(mutex_);
    report_.has_mail = settings->alarms.mail.has_value();
    report_.has_webhook = settings->alarms.webhook.has_value();
    const auto& quiet = settings->alarms.quiet;
    report_.quiet = quiet ? fmt::format("{:02}:{:02}-{:02}:{:02}", quiet->from / 60, quiet->from % 60, quiet->to / 60,
                                        quiet->to % 60)
                          : "";
  }
  for (const AlarmChannel channel : care::kAlarmChannels) {
    if (!has_channel(settings->alarms, channel)) outbox_.clear(channel);
  }
  if (!settings->alarms.has_receiver()) return;
  const care::AlarmRules rules{settings->alarms.after, is_quiet(settings->alarms, options_.museum, now)};
  const auto alarms = registry_.update(faults_in(options_.checks(), settings->alarms.has_warnings), rules, now);
  for (const AlarmChannel channel : care::kAlarmChannels) {
    if (has_channel(settings->alarms, channel)) outbox_.add(channel, alarms);
  }
  if (!alarms.empty()) write_state();
  deliver(*settings, now);
}

void AlarmService::deliver(const CareSettings& settings, WallSeconds now) {
  for (const AlarmChannel channel : care::kAlarmChannels) {
    const std::vector<Alarm> due = outbox_.due(channel, now);
    if (due.empty()) continue;
    const Status sent = send(channel, settings, due);
    if (sent) {
      outbox_.sent(channel, due.size());
      write_state();
    } else {
      outbox_.failed(channel, now);
      log(LogLevel::kWarning, "sending an alarm: " + sent.error().message());
    }
    const std::lock_guard lock(mutex_);
    report_.problem = sent ? "" : sent.error().message();
    if (sent) report_.delivered_at = time_text(now);
  }
}

Status AlarmService::send(AlarmChannel channel, const CareSettings& settings, const std::vector<Alarm>& alarms) const {
  const care::AlarmSender sender{name_of(options_.museum), options_.page(), Catalogue::of(settings.language)};
  if (channel == AlarmChannel::kWebhook) {
    return care::send_webhook(*settings.alarms.webhook, care::webhook_json(alarms, sender));
  }
  const Alarm& first = alarms.front();
  const std::string id =
      fmt::format("{}-{}-{}", first.at.time_since_epoch().count(), first.is_over ? "over" : "begun", first.fault.id);
  return care::send_mail(*settings.alarms.mail, care::mail_text(alarms, sender, *settings.alarms.mail, id));
}

AlarmService::Report AlarmService::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

std::optional<Check> AlarmService::check() const {
  const Report now = report();
  if (!now.has_mail && !now.has_webhook) return std::nullopt;
  if (now.problem.empty()) return Check{"alarms", "Alarms", CheckLevel::kOk, "They reach somebody.", ""};
  return Check{"alarms", "Alarms", CheckLevel::kWarning, "An alarm could not be delivered: " + now.problem + ".",
               "It is tried again by itself. Correct care.toml on the stick, and plug it in again."};
}

Status AlarmService::send_test() const {
  TRY_ASSIGN(const CareSettings settings, care::read_care_settings(options_.museum.care()));
  if (!settings.alarms.has_receiver()) {
    return Error(ErrorCode::kNotFound, "nobody gets alarms; add [alarms.mail] or [alarms.webhook] to care.toml");
  }
  const WallSeconds now = now_of_clock();
  const std::vector<Alarm> test{
      {{"test", "A test of the alarms", "Nothing is wrong: somebody pressed the button on the operator page.", ""},
       now,
       now,
       false}};
  for (const AlarmChannel channel : care::kAlarmChannels) {
    if (has_channel(settings.alarms, channel)) TRY(send(channel, settings, test));
  }
  return Done{};
}

void AlarmService::read_state() {
  const auto take = [](const Status& read) {
    if (!read) log(LogLevel::kWarning, read.error().message() + ", ignoring");
  };
  if (const auto known = read_text_file(options_.keep / kRegistryFile, kMaxStateBytes))
    take(registry_.read_json(*known, kRegistryFile));
  if (const auto waiting = read_text_file(options_.keep / kOutboxFile, kMaxStateBytes))
    take(outbox_.read_json(*waiting, kOutboxFile));
}

void AlarmService::write_state() const {
  for (const auto& [name, text] :
       {std::pair(kRegistryFile, registry_.to_json()), std::pair(kOutboxFile, outbox_.to_json())}) {
    const Status written = write_file_atomically(options_.keep / name, std::string_view(text));
    if (!written) log(LogLevel::kError, written.error().message());
  }
}

}  // namespace cyclorama::operations
