// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/setup_offer.h"

#include <fmt/format.h>

#include <array>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/config/toml_edit.h"
#include "common/config/toml_text.h"
#include "common/room/installation.h"

namespace cyclorama::setup {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSite = "site.toml";
constexpr const char* kInstallation = "installation.toml";
constexpr const char* kCalibrator = "calibrator.toml";

std::string text_of(const SettingsFiles& files, const char* name) {
  const auto found = files.find(name);
  return found == files.end() ? "" : found->second;
}

std::string toml_list(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + toml_string(text);
  return "[" + list + "]";
}

const Fields& fields_in(const std::map<std::string, StepDraft>& all, const std::string& step) {
  static const Fields kNone;
  const auto found = all.find(step);
  return found == all.end() ? kNone : found->second.fields;
}

Result<SettingsFiles> farm_offer(const Fields& fields, const std::string& site, const SettingsFiles& brought) {
  SettingsFiles offer = brought;
  TRY_ASSIGN(std::string text,
             with_value(site, kSite, "farm", "coordinators", toml_list(list_in(text_in(fields, "coordinators")))));
  for (const auto& [key, file] : {std::pair{"authority", "tls/authority.crt"},
                                  std::pair{"certificate", "tls/certificate.crt"}, std::pair{"key", "tls/key.pem"}}) {
    if (!brought.contains(file)) continue;
    TRY_ASSIGN(text, with_value(text, kSite, "farm", key, toml_string(file)));
  }
  offer[kSite] = text;
  return offer;
}

Result<SettingsFiles> camera_offer(const Fields& fields, const std::string& calibrator, const SettingsFiles& brought) {
  SettingsFiles offer = brought;
  TRY_ASSIGN(std::string text, with_value(calibrator, kCalibrator, "camera", "kind", "\"v4l2\""));
  TRY_ASSIGN(text, with_value(text, kCalibrator, "camera", "port", toml_string(text_in(fields, "calibration"))));
  if (brought.contains("camera.json")) {
    TRY_ASSIGN(text, with_value(text, kCalibrator, "camera", "lens", "\"camera.json\""));
  }
  offer[kCalibrator] = text;
  return offer;
}

/// Returns a text of [table] in a settings file; empty if there is none, or the file cannot be read.
std::string value_in(const std::string& file, const char* table, const char* key) {
  auto config = Config::parse(file, "settings");
  return config ? config->root().table(table).text(key, "") : "";
}

Fields first_projectors(const SetupFacts& facts) {
  static constexpr std::array kThree{"left", "middle", "right"};
  static constexpr std::array kTwo{"left", "right"};
  const std::size_t count = facts.plugged.size();
  Fields fields{{"count", count == 0 ? "1" : std::to_string(count)}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = count == 3 ? kThree.at(i) : count == 2 ? kTwo.at(i) : fmt::format("projector-{}", i + 1);
    fields[fmt::format("{}.name", i + 1)] = name;
    fields[fmt::format("{}.connector", i + 1)] = facts.plugged[i].connector;
    fields[fmt::format("{}.turn_deg", i + 1)] = "0";
  }
  return fields;
}

}  // namespace

Result<SettingsFiles> offer_of(const std::string& step, const std::map<std::string, StepDraft>& all,
                               const SetupFacts& facts, const SettingsFiles& in_use, const SettingsFiles& brought) {
  for (const std::string& needed :
       step == kWallStep ? std::vector<std::string>{kProjectorsStep, step} : std::vector<std::string>{step}) {
    const auto problems = problems_of(needed, all, facts);
    if (problems.empty()) continue;
    return Error(ErrorCode::kInvalidArgument, problems.front().sentence);
  }
  const Fields& fields = fields_in(all, step);
  const std::string site = text_of(in_use, kSite);
  SettingsFiles offer;
  if (step == kNameStep) {
    TRY_ASSIGN(offer[kSite], with_value(site, kSite, "farm", "museum", toml_string(text_in(fields, "museum"))));
  } else if (step == kNetworkStep) {
    TRY_ASSIGN(offer[kSite], with_table(site, kSite, "network", network_toml(network_of(fields))));
    offer.insert(brought.begin(), brought.end());
  } else if (step == kProjectorsStep || step == kWallStep) {
    offer[kInstallation] =
        installation_toml(plan_of(fields_in(all, kProjectorsStep), fields_in(all, kWallStep), facts));
  } else if (step == kCamerasStep) {
    return camera_offer(fields, text_of(in_use, kCalibrator), brought);
  } else if (step == kFarmStep) {
    return farm_offer(fields, site, brought);
  } else if (step == kTourStep) {
    TRY_ASSIGN(offer[kSite], with_value(site, kSite, "farm", "scene", toml_string(text_in(fields, "scene"))));
  }
  return offer;
}

Status write_offer(const fs::path& folder, const SettingsFiles& files) {
  std::error_code failed;
  fs::remove_all(folder, failed);
  fs::create_directories(folder, failed);
  // Keys and passwords lie in it.
  if (!failed) fs::permissions(folder, fs::perms::owner_all, failed);
  if (failed) return Error(ErrorCode::kSystem, fmt::format("making '{}': {}", folder.string(), failed.message()));
  for (const auto& [name, content] : files) {
    const fs::path path = folder / name;
    fs::create_directories(path.parent_path(), failed);
    if (failed) return Error(ErrorCode::kSystem, fmt::format("making '{}': {}", folder.string(), failed.message()));
    TRY(write_file_atomically(path, std::string_view(content)));
  }
  return Done{};
}

Fields first_fields(const std::string& step, const SettingsFiles& in_use, const SetupFacts& facts) {
  const std::string site = text_of(in_use, kSite);
  if (step == kNameStep) return {{"museum", value_in(site, "farm", "museum")}};
  if (step == kNetworkStep) {
    const auto network = parse_network_settings(site, kSite);
    return fields_of(network ? *network : NetworkSettings{});
  }
  if (step == kProjectorsStep) return first_projectors(facts);
  if (step == kWallStep) return {{"shape", "round"}};
  if (step == kCamerasStep) {
    const std::string port = value_in(text_of(in_use, kCalibrator), "camera", "port");
    return {{"calibration", port.empty() && facts.cameras.size() == 1 ? facts.cameras.front() : port}};
  }
  if (step == kFarmStep) {
    auto config = Config::parse(site, kSite);
    std::string text;
    if (config) {
      for (const std::string& one : config->root().table("farm").texts("coordinators", std::vector<std::string>{}))
        text += (text.empty() ? "" : ", ") + one;
    }
    return {{"coordinators", text}};
  }
  return {{"scene", value_in(site, "farm", "scene")}};
}

}  // namespace cyclorama::setup
