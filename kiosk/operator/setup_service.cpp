// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/setup_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/edid/sockets.h"
#include "common/room/installation.h"
#include "kiosk/network/network_trial.h"
#include "kiosk/operator/login_checks.h"
#include "kiosk/operator/sessions.h"
#include "kiosk/provision/pin.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/provision/settings_check.h"

namespace cyclorama::operations {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxSettingsBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxReportBytes = std::size_t{64} << 20;
constexpr Duration kOfferTimeout = std::chrono::minutes(5);
constexpr std::size_t kCodeLength = 32;  // 128 bits.
constexpr int kEthernet = 1;             // ARPHRD_ETHER.

std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

std::string first_line_of(const fs::path& file) {
  const auto text = read_text_file(file, kMaxSettingsBytes);
  return text ? text->substr(0, text->find('\n')) : "";
}

/// A file that a step takes, and how its content begins.
struct BroughtFile {
  std::string_view step;
  std::string_view name;
  std::string_view begins;
  std::string_view kind;
};
constexpr std::array kBroughtFiles{
    BroughtFile{setup::kFarmStep, "tls/authority.crt", "-----BEGIN CERTIFICATE", "a certificate"},
    BroughtFile{setup::kFarmStep, "tls/certificate.crt", "-----BEGIN CERTIFICATE", "a certificate"},
    BroughtFile{setup::kFarmStep, "tls/key.pem", "-----BEGIN ", "a key"},
    BroughtFile{setup::kNetworkStep, "8021x-authority.crt", "-----BEGIN CERTIFICATE", "a certificate"},
    BroughtFile{setup::kNetworkStep, "8021x-certificate.crt", "-----BEGIN CERTIFICATE", "a certificate"},
    BroughtFile{setup::kNetworkStep, "8021x-key.pem", "-----BEGIN ", "a key"},
    BroughtFile{setup::kNetworkStep, "8021x-password", "", "a password"},
    BroughtFile{setup::kCamerasStep, "camera.json", "{", "a lens"},
};

Json step_of(const setup::StepDraft& draft, const std::vector<setup::FieldProblem>& problems, bool is_in_use) {
  Json json{{"revision", draft.revision}, {"by", printable(draft.by)}, {"at", draft.at},
            {"fields", draft.fields},     {"problems", Json::array()}, {"in_use", is_in_use}};
  for (const setup::FieldProblem& problem : problems)
    json["problems"].push_back({{"field", problem.field}, {"sentence", problem.sentence}});
  return json;
}

Json wall_json(const setup::RoomPlan& plan) {
  const auto reach = plan.projectors.empty() ? Result<setup::Reach>(Error(ErrorCode::kNotFound, "no projector"))
                                             : setup::reach_of(plan);
  if (!reach) return nullptr;
  Json json{{"length_m", reach->length_m}, {"bottom_m", plan.bottom_m},  {"top_m", plan.top_m},
            {"eye_m", plan.eye_m},         {"lit", reach->lit_fraction}, {"shared", reach->shared_fraction},
            {"hints", reach->hints},       {"pictures", Json::array()}};
  for (std::size_t i = 0; i < reach->pictures.size(); ++i) {
    Json points = Json::array();
    for (const setup::WallPoint& point : reach->pictures[i]) points.push_back({point.along_m, point.height_m});
    json["pictures"].push_back({{"name", plan.projectors[i].name}, {"points", points}});
  }
  return json;
}

std::vector<std::string> ethernet_cables(const fs::path& net) {
  std::vector<std::string> cables;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(net, ignored)) {
    const std::string name = entry.path().filename().string();
    if (first_line_of(entry.path() / "type") == std::to_string(kEthernet) && !name.starts_with("museum-"))
      cables.push_back(name);
  }
  std::ranges::sort(cables);
  return cables;
}

/// Returns the port of a USB camera as V4L2 names it, "usb-0000:00:14.0-2", from its folder in the kernel's tree:
/// ".../0000:00:14.0/usb1/1-2/1-2:1.0"; empty for another kind of camera.
std::string usb_port_of(const fs::path& device) {
  std::string controller;
  std::string port;
  bool is_in_bus = false;
  for (const fs::path& part : device) {
    const std::string name = part.string();
    if (!is_in_bus && name.starts_with("usb")) {
      is_in_bus = true;
    } else if (!is_in_bus) {
      controller = name;
    } else if (name.find(':') == std::string::npos && name.find('-') != std::string::npos) {
      port = name.substr(name.find('-') + 1);
    }
  }
  return is_in_bus && !port.empty() ? fmt::format("usb-{}-{}", controller, port) : "";
}

std::vector<std::string> camera_ports(const fs::path& video) {
  std::vector<std::string> ports;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(video, failed)) {
    const fs::path device = fs::canonical(entry.path() / "device", failed);
    const std::string port = failed ? "" : usb_port_of(device);
    // A camera has several entries, for pictures and for their descriptions.
    if (!port.empty() && std::ranges::find(ports, port) == ports.end()) ports.push_back(port);
  }
  std::ranges::sort(ports);
  return ports;
}

}  // namespace

SetupService::SetupService(SetupPlace place)
    : place_(std::move(place)), draft_(place_.keep / "setup.json"), blinker_(place_.display) {}

setup::SetupFacts SetupService::facts() const {
  setup::SetupFacts facts;
  for (const Socket& socket : list_sockets(place_.devices / "drm")) {
    if (!socket.is_connected) continue;
    setup::PluggedProjector plugged{socket.connector, socket.edid ? socket.edid->text() : ""};
    if (socket.edid && !socket.edid->timings.empty()) {
      plugged.width_px = socket.edid->timings.front().horizontal.visible;
      plugged.height_px = socket.edid->timings.front().vertical.visible;
    }
    facts.plugged.push_back(std::move(plugged));
  }
  facts.cables = ethernet_cables(place_.devices / "net");
  facts.cameras = camera_ports(place_.devices / "video4linux");
  return facts;
}

setup::SettingsFiles SetupService::in_use() const {
  setup::SettingsFiles files;
  for (const char* const name : {"site.toml", "installation.toml", "calibrator.toml"}) {
    if (auto text = read_text_file(place_.museum.settings() / name, kMaxSettingsBytes)) files[name] = *std::move(text);
  }
  return files;
}

setup::SettingsFiles SetupService::brought(const std::string& step) const {
  setup::SettingsFiles files;
  for (const BroughtFile& file : kBroughtFiles) {
    if (file.step != step) continue;
    if (auto text = read_text_file(place_.keep / "brought" / file.name, kMaxSettingsBytes))
      files[std::string(file.name)] = *std::move(text);
  }
  return files;
}

std::map<std::string, setup::StepDraft> SetupService::drafts(const setup::SetupFacts& facts) const {
  std::map<std::string, setup::StepDraft> all = draft_.steps();
  const setup::SettingsFiles settings = in_use();
  for (const std::string& name : setup::field_steps()) {
    setup::StepDraft& step = all[name];
    if (step.revision == 0) step.fields = setup::first_fields(name, settings, facts);
  }
  return all;
}

std::string SetupService::json() const {
  const setup::SetupFacts known = facts();
  const auto all = drafts(known);
  const setup::SettingsFiles settings = in_use();
  const network::TrialReport trial = network::read_trial(place_.run);
  Json json{{"can_change", !place_.requests.empty()},
            {"has_pin", has_pin(place_.museum)},
            {"damage", draft_.damage()},
            {"is_checking", is_offer_pending()},
            {"has_calibration", has_calibration()},
            {"network", {{"state", trial.state}, {"sentence", trial.sentence}}},
            {"blinks", {{"name", blinker_.now()}, {"trouble", blinker_.trouble()}}},
            {"plugged", Json::array()},
            {"cables", known.cables},
            {"cameras", known.cameras},
            {"steps", Json::object()}};
  for (const setup::PluggedProjector& one : known.plugged) {
    json["plugged"].push_back({{"connector", one.connector},
                               {"text", printable(one.text)},
                               {"width_px", one.width_px},
                               {"height_px", one.height_px}});
  }
  for (const std::string& name : setup::field_steps()) {
    const auto offer = setup::offer_of(name, all, known, settings, brought(name));
    const bool is_in_use = offer && std::ranges::all_of(*offer, [&](const auto& file) {
                             const auto present = settings.find(file.first);
                             return present != settings.end() && present->second == file.second;
                           });
    json["steps"][name] = step_of(all.at(name), setup::problems_of(name, all, known), is_in_use);
    for (const auto& [file, content] : brought(name)) json["steps"][name]["brought"].push_back(file);
  }
  json["wall"] =
      wall_json(setup::plan_of(all.at(setup::kProjectorsStep).fields, all.at(setup::kWallStep).fields, known));
  return dumped(json);
}

std::string SetupService::step_json(const std::string& step) const {
  const setup::SetupFacts known = facts();
  const auto all = drafts(known);
  return dumped(step_of(all.at(step), setup::problems_of(step, all, known), false));
}

Result<int> SetupService::save(const StepChange& change, const std::string& by) {
  const auto& steps = setup::field_steps();
  if (std::ranges::find(steps, change.step) == steps.end())
    return Error(ErrorCode::kNotFound, fmt::format("there is no step '{}'", printable(change.step)));
  return draft_.save(change.step, change.revision, change.fields, by, provision::time_text(std::time(nullptr)));
}

bool SetupService::is_offer_pending() const {
  const std::lock_guard lock(mutex_);
  if (!offered_at_ || SteadyClock().now() - *offered_at_ > kOfferTimeout) return false;
  const auto report = read_text_file(place_.museum.root / provision::kProvisioningReportFile, kMaxSettingsBytes);
  return (report ? *report : "") == report_before_;
}

Status SetupService::offer(const setup::SettingsFiles& files, const char* request, const std::string& content) {
  if (place_.requests.empty()) {
    return Error(ErrorCode::kNotFound,
                 "the settings of this computer are not the page's to change; bring them on a USB stick");
  }
  if (is_offer_pending()) return Error(ErrorCode::kBusy, "settings are being checked now; wait for their result");
  const std::lock_guard lock(mutex_);
  TRY(setup::write_offer(place_.keep / "offer", files));
  const auto report = read_text_file(place_.museum.root / provision::kProvisioningReportFile, kMaxSettingsBytes);
  report_before_ = report ? *report : "";
  // A trial of the network reports its own end.
  offered_at_ = content.empty() ? std::optional(SteadyClock().now()) : std::nullopt;
  return write_file_atomically(place_.requests / request, content + "\n");
}

Result<std::string> SetupService::use(const std::string& step, int seen_revision) {
  const setup::SetupFacts known = facts();
  const auto all = drafts(known);
  const auto draft = all.find(step);
  if (draft == all.end()) return Error(ErrorCode::kNotFound, fmt::format("there is no step '{}'", printable(step)));
  if (draft->second.revision != seen_revision)
    return Error(ErrorCode::kBusy, "somebody has changed this step meanwhile; look at it again");
  TRY_ASSIGN(const setup::SettingsFiles files, setup::offer_of(step, all, known, in_use(), brought(step)));
  if (step != setup::kNetworkStep) {
    TRY(offer(files, "offer", ""));
    return std::string();
  }
  if (network::read_trial(place_.run).state == "trying")
    return Error(ErrorCode::kBusy, "a network is being tried now; confirm it, or wait for its end");
  TRY_ASSIGN(std::string code, new_token());
  code.resize(kCodeLength);
  TRY(offer(files, "network-try", code));
  const std::lock_guard lock(mutex_);
  network_code_ = code;
  return code;
}

Status SetupService::keep_network(const std::string& code) {
  const std::lock_guard lock(mutex_);
  if (network_code_.empty() || code != network_code_)
    return Error(ErrorCode::kInvalidArgument, "no network with this code is being tried any more");
  return write_file_atomically(place_.requests / "network-keep", code + "\n");
}

Status SetupService::bring(const std::string& step, const std::string& name, const std::string& content) {
  const auto found = std::ranges::find_if(
      kBroughtFiles, [&](const BroughtFile& file) { return file.step == step && file.name == name; });
  if (found == kBroughtFiles.end())
    return Error(ErrorCode::kInvalidArgument, fmt::format("this step takes no file '{}'", printable(name)));
  if (content.empty() || !content.starts_with(found->begins)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("this file is not {}; choose the one named like {}", found->kind, found->name));
  }
  setup::SettingsFiles all = brought(step);
  all[name] = content;
  const fs::path path = place_.keep / "brought" / name;
  std::error_code failed;
  fs::create_directories(path.parent_path(), failed);
  fs::permissions(place_.keep / "brought", fs::perms::owner_all, failed);
  return write_file_atomically(path, std::string_view(content));
}

Status SetupService::offer_first_pin(const std::string& pin) {
  if (has_pin(place_.museum)) return Error(ErrorCode::kBusy, "this museum has a PIN already; log in with it");
  std::string plain;
  for (const char c : pin) {
    if (c != ' ') plain += c;
  }
  TRY_ASSIGN(const std::string hash, provision::hashed_pin(plain));
  return offer({{provision::kPinFile, hash + "\n"}}, "offer", "");
}

Status SetupService::blink(const std::string& projector) {
  TRY_ASSIGN(const Installation room, read_installation(place_.museum.settings() / "installation.toml"));
  const auto found = std::ranges::find(room.projectors, projector, &InstalledProjector::name);
  if (found == room.projectors.end()) {
    return Error(ErrorCode::kNotFound,
                 fmt::format("the settings in use have no projector '{}'; use this step first", printable(projector)));
  }
  return blinker_.blink(projector, found->lens.width_px, found->lens.height_px);
}

bool SetupService::has_calibration() const {
  std::error_code ignored;
  return fs::exists(place_.museum.root / "calibration/calibration.json", ignored);
}

Result<std::string> SetupService::report() const {
  fs::path newest;
  std::error_code ignored;
  // Their names are dates, in the order of time.
  for (const fs::directory_entry& one :
       fs::directory_iterator(place_.museum.root / "calibration/calibrations", ignored)) {
    if (fs::exists(one.path() / "report.html", ignored) && one.path() > newest) newest = one.path();
  }
  if (newest.empty()) return Error(ErrorCode::kNotFound, "there is no calibration yet");
  return read_text_file(newest / "report.html", kMaxReportBytes);
}

}  // namespace cyclorama::operations
