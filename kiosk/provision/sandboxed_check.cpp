// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/sandboxed_check.h"

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/process/child.h"
#include "kiosk/provision/folder_copy.h"
#include "kiosk/provision/pin.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxVerdictBytes = 1 << 20;
constexpr std::size_t kMaxVerdictSentences = 1000;
constexpr std::size_t kMaxVerdictText = 4000;
constexpr int kMaxProjectors = 1000;
constexpr std::string_view kOurGroups = "cyclorama-";
/// Beyond the limits of the unit itself.
constexpr ChildLimits kUnitLimits{std::chrono::minutes(25)};

bool read_word(const Json& json, const char* key, std::string* ret) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return false;
  *ret = found->get<std::string>();
  return ret->size() <= kMaxVerdictText && printable(*ret, kMaxVerdictText) == *ret;
}

bool read_words(const Json& json, const char* key, std::vector<std::string>* ret) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() > kMaxVerdictSentences) return false;
  return std::all_of(found->begin(), found->end(), [&](const Json& one) {
    return read_word(Json{{"word", one}}, "word", &ret->emplace_back());
  });
}

bool read_secret(const Json& json, SecretFile* ret) {
  std::string name;
  if (!json.is_object() || !read_word(json, "name", &name) || !read_word(json, "group", &ret->group)) return false;
  ret->name = name;
  return is_path_of_plain_names(name) && is_plain_name(ret->group) && ret->group.starts_with(kOurGroups);
}

std::vector<std::string> clean(const std::vector<std::string>& sentences) {
  std::vector<std::string> cleaned;
  // Leaves room for an ellipsis of three bytes.
  for (const std::string& sentence : sentences) cleaned.push_back(printable(sentence, kMaxVerdictText - 3));
  cleaned.resize(std::min(cleaned.size(), kMaxVerdictSentences));
  return cleaned;
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
                  {"farm", clean(verdict.farm)},
                  {"projectors", verdict.projectors},
                  {"certificate_until", verdict.certificate_until},
                  {"pin", verdict.pin ? Json(*verdict.pin) : Json(nullptr)},
                  {"secrets", secrets},
                  {"problems", clean(verdict.problems)},
                  {"remarks", clean(verdict.remarks)}};
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
  if (!read_word(json, "museum", &verdict.museum) || !read_words(json, "farm", &verdict.farm) ||
      !read_word(json, "certificate_until", &verdict.certificate_until) ||
      !read_words(json, "problems", &verdict.problems) || !read_words(json, "remarks", &verdict.remarks) ||
      projectors == json.end() || !projectors->is_number_unsigned() ||
      projectors->get<std::uint64_t>() > kMaxProjectors || pin == json.end() || secrets == json.end() ||
      !secrets->is_array() || secrets->size() > kMaxVerdictSentences) {
    return bad;
  }
  verdict.projectors = projectors->get<int>();
  if (!pin->is_null() && (!read_word(json, "pin", &verdict.pin.emplace()) || !check_pin(*verdict.pin))) return bad;
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
  fs::remove(how.verdict, ignored);  // It has the PIN.
  if (end.exit_code == 0 && text) return parse_verdict(*text);
  return Error(ErrorCode::kUnavailable,
               fmt::format("the check of the settings failed: {}; start this computer again, and plug the stick in",
                           end.output.empty() ? "it gave no verdict" : printable(end.output, 500)));
}

}  // namespace cyclorama::provision
