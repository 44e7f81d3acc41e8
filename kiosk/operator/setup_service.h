// SPDX-License-Identifier: Apache-2.0
/// The installer's way behind the page: its drafts, and how they come into use.
///
///   fields ──typed──▶ KEEP/setup.json ──use──▶ KEEP/offer ──request──▶ systemd: checked like a stick, in use or refused
///                                                └─ network: tried for a minute, kept by the code alone
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "kiosk/operator/blinker.h"
#include "kiosk/operator/museum_state.h"
#include "kiosk/setup/setup_draft.h"
#include "kiosk/setup/setup_fields.h"
#include "kiosk/setup/setup_offer.h"

namespace cyclorama::operations {

/// Folders and addresses of this computer. A value.
struct SetupPlace {
  MuseumState museum;
  std::filesystem::path keep;      ///< The page's own folder.
  std::filesystem::path requests;  ///< Empty: the settings of this computer are not the page's to change.
  std::filesystem::path run = "/run";
  std::filesystem::path devices = "/sys/class";  ///< With drm, net and video4linux.
  std::string display{};                         ///< Its address; empty: no projector can blink.
};

/// A change of one step's fields, by somebody who saw `revision`.
struct StepChange {
  std::string step;
  int revision = 0;
  setup::Fields fields;
};

/// Thread-safe.
class SetupService {
 public:
  explicit SetupService(SetupPlace place);

  /// Returns everything that the page shows, as JSON: setup_routes.h has its form.
  [[nodiscard]] std::string json() const;
  /// Errors: kNotFound if there is no such step; those of SetupDraft::save().
  Result<int> save(const StepChange& change, const std::string& by);
  /// Returns the present state of one step as JSON, for somebody whose change came too late.
  [[nodiscard]] std::string step_json(const std::string& step) const;
  /// Offers a step as settings. Returns the code that confirms the trial of a network, else an empty text. Errors:
  /// those of setup::offer_of(); kBusy if somebody changed the step meanwhile, or an offer is being checked; kNotFound
  /// if this computer's settings are not the page's.
  Result<std::string> use(const std::string& step, int seen_revision);
  /// Confirms the network that is being tried. Errors: kInvalidArgument if this is not its code.
  Status keep_network(const std::string& code);
  /// Keeps a file for a step until it is used. Errors: kInvalidArgument if the step takes no such file, or it is not of
  /// that kind.
  Status bring(const std::string& step, const std::string& name, const std::string& content);
  /// Offers the first PIN, as its hash. Errors: kBusy if there is one; those of provision::hashed_pin(), and use()'s.
  Status offer_first_pin(const std::string& pin);
  /// Lets one projector blink for some seconds. Errors: kNotFound if the settings in use have no such projector, or no
  /// display is watched.
  Status blink(const std::string& projector);
  /// Returns the newest calibration report. Errors: kNotFound if there is none.
  [[nodiscard]] Result<std::string> report() const;
  [[nodiscard]] const SetupPlace& place() const { return place_; }

 private:
  [[nodiscard]] setup::SetupFacts facts() const;
  [[nodiscard]] setup::SettingsFiles in_use() const;
  [[nodiscard]] setup::SettingsFiles brought(const std::string& step) const;
  /// Returns the drafts of all steps; those that nobody has touched have their first fields.
  [[nodiscard]] std::map<std::string, setup::StepDraft> drafts(const setup::SetupFacts& facts) const;
  Status offer(const setup::SettingsFiles& files, const char* request, const std::string& content);
  [[nodiscard]] bool is_offer_pending() const;
  [[nodiscard]] bool has_calibration() const;

  const SetupPlace place_;
  setup::SetupDraft draft_;
  Blinker blinker_;
  mutable std::mutex mutex_;  ///< Guards the following, and the offer's folder.
  std::string network_code_;
  std::string report_before_;  ///< The provisioning report that was there before the last offer.
  std::optional<TimePoint> offered_at_;
};

}  // namespace cyclorama::operations
