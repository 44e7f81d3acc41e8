// SPDX-License-Identifier: Apache-2.0
#include "kiosk/network/network_trial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/network/network_settings.h"
#include "common/process/child.h"
#include "kiosk/network/network_files.h"

namespace cyclorama::network {
namespace {

namespace fs = std::filesystem;

constexpr Duration kLookPeriod = std::chrono::milliseconds(250);
constexpr std::size_t kMaxReportBytes = 4096;
constexpr std::size_t kMaxCode = 100;

/// Takes the one lock of this computer's network. Errors: kBusy if a trial runs.
Result<UniqueFd> lock_network(const NetworkPlace& place) {
  const fs::path folder = place.run / "cyclorama-network";
  std::error_code failed;
  fs::create_directories(folder, failed);
  UniqueFd lock(::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (lock.get() < 0) return Error::from_errno(fmt::format("opening '{}'", (folder / "lock").string()));
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) return lock;
  return Error(ErrorCode::kBusy, "network settings are being tried already; wait for their end");
}

Status reload(const NetworkPlace& place, const std::vector<std::string>& changed) {
  if (changed.empty() || place.reload.empty()) return Done{};
  std::vector<std::string> command = place.reload;
  command.insert(command.end(), changed.begin(), changed.end());
  TRY_ASSIGN(const ChildEnd end, run_child(command));
  if (end.exit_code == 0) return Done{};
  return Error(ErrorCode::kSystem,
               fmt::format("the network did not take its settings: {}", printable(end.output, 300)));
}

Status make(const NetworkPlace& place, const NetworkSettings& network, const std::vector<fs::path>& folders) {
  TRY_ASSIGN(const std::vector<NetworkFile> files, network_files(network, folders));
  TRY_ASSIGN(const std::vector<std::string> changed, put_network_files(files, place.run));
  return reload(place, changed);
}

Status make_in_use(const NetworkPlace& place) {
  TRY_ASSIGN(const NetworkSettings network, read_network_settings(place.settings / "site.toml"));
  return make(place, network, {place.settings});
}

void report(const NetworkPlace& place, const TrialReport& said) {
  const nlohmann::ordered_json json{{"state", said.state}, {"sentence", said.sentence}};
  // Without the report the page shows no trial; the trial itself is the same.
  static_cast<void>(write_file_atomically(place.run / kTrialFile, std::string_view(json.dump() + "\n")));
}

/// Returns the first line of a file that belongs to another user: a link is not followed.
std::string line_in(const fs::path& path) {
  const UniqueFd file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (file.get() < 0) return "";
  std::array<char, kMaxCode> text{};
  const ssize_t length = ::read(file.get(), text.data(), text.size());
  if (length <= 0) return "";
  const std::string_view all(text.data(), static_cast<std::size_t>(length));
  return std::string(all.substr(0, all.find('\n')));
}

/// Waits for the confirmation. Returns why there was none; nothing: there was one.
std::optional<std::string> why_not_confirmed(const TrialOrder& order, const Clock& clock,
                                             const std::function<bool(TimePoint)>& stopped) {
  const TimePoint end = clock.now() + order.length;
  while (clock.now() < end) {
    if (line_in(order.keep) == order.code) return std::nullopt;
    if (stopped(std::min(end, clock.now() + kLookPeriod))) return "the computer stopped before anybody confirmed them";
  }
  return fmt::format("nobody confirmed them within {} seconds, so this page may not have been reachable",
                     std::chrono::duration_cast<std::chrono::seconds>(order.length).count());
}

/// Tries the offer. Returns why it is not kept; nothing: it is.
std::optional<std::string> why_not_kept(const NetworkPlace& place, const NetworkSettings& offered,
                                        const TrialOrder& order, const Clock& clock,
                                        const std::function<bool(TimePoint)>& stopped) {
  if (const Status made = make(place, offered, {order.offer, place.settings}); !made) return made.error().message();
  report(place, {"trying", ""});
  if (auto why = why_not_confirmed(order, clock, stopped)) return why;
  if (const Status installed = order.install(); !installed) return installed.error().message();
  const auto in_use = read_network_settings(place.settings / "site.toml");
  if (!in_use) return in_use.error().message();
  if (!(*in_use == offered)) return "the settings as a whole were refused; the card 'Settings' has the reason";
  return std::nullopt;
}

}  // namespace

Status apply_in_use(const NetworkPlace& place) {
  auto lock = lock_network(place);
  if (!lock) return lock.error().code() == ErrorCode::kBusy ? Status(Done{}) : Status(lock.error());
  return make_in_use(place);
}

Result<TrialEnd> run_trial(const NetworkPlace& place, const TrialOrder& order, const Clock& clock,
                           const std::function<bool(TimePoint)>& stopped) {
  if (order.code.empty() || order.code.size() >= kMaxCode)
    return Error(ErrorCode::kInvalidArgument, "a trial needs a code of up to 99 letters, by which it is confirmed");
  TRY_ASSIGN(const UniqueFd lock, lock_network(place));
  const auto refused = [&](const Error& error) {
    report(place, {"taken-back", error.message()});
    return error;
  };
  auto offered = read_network_settings(order.offer / "site.toml");
  if (!offered) return refused(offered.error());
  const auto why = why_not_kept(place, *offered, order, clock, stopped);
  // Also after a success: the files that the login names are now those in use.
  const Status restored = make_in_use(place);
  if (!restored) return refused(restored.error());
  report(place, why ? TrialReport{"taken-back", *why} : TrialReport{"kept", ""});
  return why ? TrialEnd::kTakenBack : TrialEnd::kKept;
}

TrialReport read_trial(const fs::path& run) {
  const auto text = read_text_file(run / kTrialFile, kMaxReportBytes);
  if (!text) return {};
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  const auto word = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
  };
  if (word("state").empty()) return {};
  return {printable(word("state"), 20), printable(word("sentence"), 500)};
}

}  // namespace cyclorama::network
