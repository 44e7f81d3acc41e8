// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/sandboxed_check.h"

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/process/child.h"
#include "kiosk/provision/folder_copy.h"
#include "kiosk/provision/pin.h"
#include "kiosk/provision/sentences.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxVerdictBytes = 1 << 20;
constexpr std::size_t kMaxSecrets = 1000;
constexpr int kMaxProjectors = 1000;
constexpr std::string_view kOurGroups = "cyclorama-";
/// Beyond the limits of the unit itself.
constexpr ChildLimits kUnitLimits{std::chrono::minutes(25)};

bool read_secret(const Json& json, SecretFile* ret) {
  std::string name;
  if (!json.is_object() || !read_sentence(json, "name", &name) || !read_sentence(json, "group", &ret->group))
    return false;
  ret->name = name;
  return is_path_of_plain_names(name) && is_plain_name(ret->group) && ret->group.starts_with(kOurGroups);
}

Status give_to(const fs::path& folder, const std::string& group) {
  const ::group* const known = ::getgrnam(group.c_str());
  if (known == nullptr) {
    return Error(ErrorCode::kNotFound, fmt::format("there is no group '{}'; run systemd-sysusers", group));
  }
  const auto give = [&](const fs::path& path, mode_t mode) {
    return ::lchown(path.c_str(), static_cast<uid_t>(-1), known->gr_gid) == 0 && ::chmod(path.c_str(), mode) == 0;
  };
  constexpr mode_t kFolderMode = 0750, kFileMode = 0640;
  bool is_given = give(folder, kFolderMode);
  std::error_code failed;
  // The copy has only plain files and folders.
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    is_given = give(entry->path(), entry->is_directory() ? kFolderMode : kFileMode) && is_given;
  }
  if (failed) return Error(ErrorCode::kSystem, fmt::format("reading '{}': {}", folder.string(), failed.message()));
  return is_given ? Status(Done{}) : Error::from_errno(fmt::format("giving '{}' to '{}'", folder.string(), group));
}

}  // namespace

std::string verdict_json(const SettingsVerdict& verdict) {
  Json secrets = Json::array();
  for (const SecretFile& secret : verdict.secrets)
    secrets.push_back({{"name", secret.name.string()}, {"group", secret.group}});
  const Json json{{"museum", printable(verdict.museum, 200)},
                  {"farm", bounded_sentences(verdict.farm)},
                  {"projectors", verdict.projectors},
                  {"certificate_until", verdict.certificate_until},
                  {"pin", verdict.pin ? Json(*verdict.pin) : Json(nullptr)},
                  {"secrets", secrets},
                  {"problems", bounded_sentences(verdict.problems)},
                  {"remarks", bounded_sentences(verdict.remarks)}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<SettingsVerdict> parse_verdict(std::string_view text) {
  const Error bad(ErrorCode::kBadData, "the check of the settings has written no verdict; plug the stick in again");
  if (text.size() > kMaxVerdictBytes) return bad;
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return bad;
  SettingsVerdict verdict;
  const auto projectors = json.find("projectors");
  const auto pin = json.find("pin");
  const auto secrets = json.find("secrets");
  if (!read_sentence(json, "museum", &verdict.museum) || !read_sentences(json, "farm", &verdict.farm) ||
      !read_sentence(json, "certificate_until", &verdict.certificate_until) ||
      !read_sentences(json, "problems", &verdict.problems) || !read_sentences(json, "remarks", &verdict.remarks) ||
      projectors == json.end() || !projectors->is_number_unsigned() ||
      projectors->get<std::uint64_t>() > kMaxProjectors || pin == json.end() || secrets == json.end() ||
      !secrets->is_array() || secrets->size() > kMaxSecrets) {
    return bad;
  }
  verdict.projectors = projectors->get<int>();
  if (!pin->is_null() && (!read_sentence(json, "pin", &verdict.pin.emplace()) || !check_pin(*verdict.pin))) return bad;
  for (const Json& secret : *secrets) {
    if (!read_secret(secret, &verdict.secrets.emplace_back())) return bad;
  }
  return verdict;
}

Result<SettingsVerdict> check_sandboxed(const fs::path& folder, const SandboxedCheck& how) {
  if (!how.group.empty()) TRY(give_to(folder, how.group));
  std::error_code ignored;
  fs::remove(how.verdict, ignored);
  TRY_ASSIGN(const ChildEnd end, run_child(how.command, kUnitLimits));
  auto text = read_text_file(how.verdict, kMaxVerdictBytes);
  fs::remove(how.verdict, ignored);  // It contains the PIN.
  if (end.exit_code == 0 && text) return parse_verdict(*text);
  return Error(ErrorCode::kUnavailable,
               fmt::format("the check of the settings failed: {}; start this computer again, and plug the stick in",
                           end.output.empty() ? "it gave no verdict" : printable(end.output, 500)));
}

}  // namespace cyclorama::provision
