// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/setup_draft.h"

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/base/file.h"
#include "common/base/text.h"

namespace cyclorama::setup {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxDraftBytes = std::size_t{256} * 1024;
constexpr std::size_t kMaxSteps = 32;
constexpr std::size_t kMaxFields = 200;
constexpr std::size_t kMaxFieldBytes = 500;

bool is_small(const Fields& fields) {
  if (fields.size() > kMaxFields) return false;
  for (const auto& [name, value] : fields) {
    if (name.size() > kMaxFieldBytes || value.size() > kMaxFieldBytes) return false;
  }
  return true;
}

}  // namespace

Result<std::map<std::string, StepDraft>> parse_draft(const std::string& text) {
  const Error bad(ErrorCode::kBadData, "it is not a draft of the installer's way");
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || json.size() > kMaxSteps) return bad;
  std::map<std::string, StepDraft> steps;
  for (const auto& [name, value] : json.items()) {
    StepDraft& step = steps[name];
    if (!value.is_object() || !value.contains("revision") || !value["revision"].is_number_integer() ||
        !value.contains("fields") || !value["fields"].is_object()) {
      return bad;
    }
    const auto revision = value["revision"].get<std::int64_t>();
    if (revision < 0 || revision > 1'000'000'000) return bad;
    step.revision = static_cast<int>(revision);
    const auto word = [&step_json = value](const char* key) {
      const auto found = step_json.find(key);
      return found != step_json.end() && found->is_string() ? found->get<std::string>() : std::string();
    };
    step.by = word("by");
    step.at = word("at");
    for (const auto& [field, content] : value["fields"].items()) {
      if (!content.is_string()) return bad;
      step.fields[field] = content.get<std::string>();
    }
    if (!is_small(step.fields)) return bad;
  }
  return steps;
}

std::string draft_json(const std::map<std::string, StepDraft>& steps) {
  Json json = Json::object();
  for (const auto& [name, step] : steps)
    json[name] = {{"revision", step.revision}, {"by", step.by}, {"at", step.at}, {"fields", step.fields}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

SetupDraft::SetupDraft(std::filesystem::path file) : file_(std::move(file)) {
  const auto text = read_text_file(file_, kMaxDraftBytes);
  if (!text && text.error().code() == ErrorCode::kNotFound) return;
  auto steps = text ? parse_draft(*text) : Result<std::map<std::string, StepDraft>>(text.error());
  if (steps) {
    steps_ = *std::move(steps);
    return;
  }
  std::error_code ignored;
  std::filesystem::rename(file_, file_.string() + ".damaged", ignored);
  damage_ = fmt::format(
      "What was typed here before cannot be read any more ({}), so the steps begin with the settings "
      "in use.",
      printable(steps.error().message(), 200));
}

std::map<std::string, StepDraft> SetupDraft::steps() const {
  const std::lock_guard lock(mutex_);
  return steps_;
}

StepDraft SetupDraft::step(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = steps_.find(name);
  return found == steps_.end() ? StepDraft{} : found->second;
}

Result<int> SetupDraft::save(const std::string& name, int seen_revision, Fields fields, const std::string& by,
                             const std::string& at) {
  if (!is_small(fields)) return Error(ErrorCode::kInvalidArgument, "a field has more than 500 letters; shorten it");
  const std::lock_guard lock(mutex_);
  std::map<std::string, StepDraft> changed = steps_;
  StepDraft& step = changed[name];
  if (step.revision != seen_revision) {
    return Error(ErrorCode::kBusy, fmt::format("{} has changed this step at {}; look at both, and choose one",
                                               step.by.empty() ? "somebody" : step.by, step.at));
  }
  step.revision += 1;
  step.by = by;
  step.at = at;
  step.fields = std::move(fields);
  const int revision = step.revision;
  const std::string json = draft_json(changed);
  if (json.size() > kMaxDraftBytes) return Error(ErrorCode::kInvalidArgument, "the steps have too many fields");
  TRY(write_file_atomically(file_, std::string_view(json)));
  steps_ = std::move(changed);
  return revision;
}

}  // namespace cyclorama::setup
