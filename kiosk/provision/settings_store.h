// SPDX-License-Identifier: Apache-2.0
/// Stores a museum's settings so that one whole set is in use at every moment, even when the power fails.
///
///   ROOT/settings ──▶ generations/000007      read by the programs; one rename switches to another set
///   ROOT/generations/000007/ site.toml ... .previous ("000006")  .contents (SHA256SUMS)
///   ROOT/generations/000006/                  put into use again by `restore`
///   ROOT/staging/                             under construction; removed after a power cut
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

namespace cyclorama::provision {

/// Called before each change of the disk; tests simulate a power cut there.
using StepHook = std::function<void(std::string_view step)>;

/// Thread-bound. Only one process at a time can open a root.
///
/// Invariants: 1. `settings` is absent or leads to a complete generation. 2. commit() and restore() change what is in
/// use in one rename, or not at all. 3. The generation in use, and the one before it, are never changed or removed.
class SettingsStore {
 public:
  /// Creates the root's folders where they are missing. Errors: kBusy if another process has it open; kSystem if the
  /// folders cannot be made.
  static Result<SettingsStore> open(const std::filesystem::path& root, StepHook hook = {});

  /// Returns the empty staging folder. Removes what an earlier attempt left.
  Result<std::filesystem::path> begin();
  /// Returns the staging folder with a copy of the settings in use. Errors: kNotFound if there are none; kSystem.
  Result<std::filesystem::path> begin_with_those_in_use();
  /// Puts the contents of the staging folder into use. `files` lists them; `secrets` get their own modes and groups.
  /// Errors: kSystem if the disk fails; nothing has changed then.
  Status commit(std::vector<CopiedFile> files, const std::vector<SecretFile>& secrets);
  /// Like commit(), for settings that only go on with those in use: restore() then leads to the ones before both.
  Status commit_instead(std::vector<CopiedFile> files, const std::vector<SecretFile>& secrets);
  /// Discards the contents of the staging folder.
  void abandon();
  /// Puts the previous settings into use as a new generation, so that a second call undoes the first. Errors: kNotFound
  /// if there are none.
  Status restore();

  /// Returns the number of the generation in use, such as "000007"; empty: none.
  [[nodiscard]] std::string in_use() const;
  [[nodiscard]] std::filesystem::path settings() const { return root_ / "settings"; }
  /// The owner's public key; empty once a stick without a key was taken; not there before the first stick.
  [[nodiscard]] std::filesystem::path owner() const { return root_ / "owner.pub"; }
  /// Returns the files in use; empty when they are unknown.
  [[nodiscard]] std::vector<CopiedFile> contents() const;

 private:
  SettingsStore(std::filesystem::path root, UniqueFd lock, StepHook hook);
  void step(std::string_view name) const;
  [[nodiscard]] std::filesystem::path staging() const { return root_ / "staging"; }
  [[nodiscard]] std::filesystem::path generation(const std::string& number) const;
  [[nodiscard]] std::string previous_of(const std::string& number) const;
  [[nodiscard]] std::string next_number() const;
  [[nodiscard]] Status copy(const std::string& number) const;
  Status commit_after(const std::string& previous, std::vector<CopiedFile> files,
                      const std::vector<SecretFile>& secrets);
  Status write_note(const char* name, std::string_view text) const;
  Status switch_to(const std::string& number);
  void prune() const;

  std::filesystem::path root_;
  UniqueFd lock_;
  StepHook hook_;
};

}  // namespace cyclorama::provision
