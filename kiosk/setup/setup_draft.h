// SPDX-License-Identifier: Apache-2.0
/// What people have typed on the installer's way so far, kept on the disk: whoever opens the page next goes on from it.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "common/base/result.h"

namespace cyclorama::setup {

using Fields = std::map<std::string, std::string>;

/// One step of the way. A value.
struct StepDraft {
  int revision = 0;  ///< Counts the changes; 0: nobody has typed anything.
  std::string by{};  ///< The address that changed it last, on the museum's network.
  std::string at{};  ///< Time of that change.
  Fields fields{};
};

/// Thread-safe. Every change is on the disk when save() returns.
class SetupDraft {
 public:
  /// Opens the file. What cannot be read is renamed to FILE.damaged, and the way begins anew; damage() then has the reason.
  explicit SetupDraft(std::filesystem::path file);

  [[nodiscard]] std::map<std::string, StepDraft> steps() const;
  [[nodiscard]] StepDraft step(const std::string& name) const;
  /// Replaces the fields of a step that has still the revision which its author saw. Returns the new revision. Errors:
  /// kBusy if somebody else has changed it meanwhile; kInvalidArgument if it is too long; kSystem if the disk fails,
  /// and then nothing has changed.
  Result<int> save(const std::string& name, int seen_revision, Fields fields, const std::string& by,
                   const std::string& at);
  [[nodiscard]] std::string damage() const { return damage_; }

 private:
  const std::filesystem::path file_;
  std::string damage_;
  mutable std::mutex mutex_;
  std::map<std::string, StepDraft> steps_;
};

/// Parses the file's text. Errors: kBadData.
Result<std::map<std::string, StepDraft>> parse_draft(const std::string& json);
[[nodiscard]] std::string draft_json(const std::map<std::string, StepDraft>& steps);

}  // namespace cyclorama::setup
