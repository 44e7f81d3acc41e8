// SPDX-License-Identifier: Apache-2.0
/// Where a museum's settings live, so that at every moment, also when the power fails, one whole set is in use.
///
///   ROOT/settings ──▶ generations/000007      what the programs read; one rename makes another set the one in use
///   ROOT/generations/000007/ site.toml ... .previous ("000006")  .contents (SHA256SUMS)
///   ROOT/generations/000006/                  what `restore` brings back
///   ROOT/staging/                             being made; whatever is left of it after a power cut is thrown away
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "kiosk/provision/folder_copy.h"
#include "kiosk/provision/settings_check.h"

namespace cyclorama {

/// Told before each change of the disk; for tests, which cut the power there.
using StepHook = std::function<void(std::string_view step)>;

/// Thread-bound. One process at a time has a root open.
///
/// Invariants: 1. `settings` is absent or leads to a whole generation.   2. commit() and restore() change what is in
/// use in one rename, or not at all.   3. The generation in use, and the one before it, are never changed or removed.
class SettingsStore {
 public:
  /// Makes the root's folders where they are missing. kBusy  another process has it open.     kSystem  they cannot be
  /// made.
  static Result<SettingsStore> open(const std::filesystem::path& root, StepHook hook = {});

  /// An empty folder, to be filled. What an earlier try left is removed.
  Result<std::filesystem::path> begin();
  /// Takes what lies in it into use. `files` are its contents; `secrets` get modes and groups of their own.
  /// kSystem  the disk: nothing has changed.
  Status commit(std::vector<CopiedFile> files, const std::vector<SecretFile>& secrets);
  /// Throws away what lies in it.
  void abandon();
  /// Takes the settings before those in use into use, as a new generation: twice is back again. kNotFound  there are
  /// none.
  Status restore();

  /// "000007"; empty: none.
  [[nodiscard]] std::string in_use() const;
  [[nodiscard]] std::filesystem::path settings() const { return root_ / "settings"; }
  /// Of what is in use; nothing when that is not known.
  [[nodiscard]] std::vector<CopiedFile> contents() const;

 private:
  SettingsStore(std::filesystem::path root, UniqueFd lock, StepHook hook);
  void step(std::string_view name) const;
  [[nodiscard]] std::filesystem::path staging() const { return root_ / "staging"; }
  [[nodiscard]] std::filesystem::path generation(const std::string& number) const;
  [[nodiscard]] std::string previous_of(const std::string& number) const;
  [[nodiscard]] std::string next_number() const;
  Status write_note(const char* name, std::string_view text) const;
  Status switch_to(const std::string& number);
  void prune() const;

  std::filesystem::path root_;
  UniqueFd lock_;
  StepHook hook_;
};

}  // namespace cyclorama
