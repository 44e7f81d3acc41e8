// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/settings_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/address.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/edid/sockets.h"
#include "common/image/image_file.h"
#include "common/network/network_settings.h"
#include "common/opening/opening_hours.h"
#include "common/room/installation.h"
#include "common/wand/wand.h"
#include "kiosk/care/care_settings.h"
#include "kiosk/provision/folder_check.h"
#include "kiosk/provision/operator_settings.h"
#include "kiosk/tour/plan/tour_folder.h"
#include "kiosk/tour/session/tour_settings.h"
#include "kiosk/update/update_settings.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextBytes = 1 << 20;
constexpr const char* kTourGroup = "cyclorama-tour";
constexpr const char* kOperatorGroup = "cyclorama-operator";
constexpr const char* kRootGroup = "root";
constexpr const char* kProjectorsGroup = "cyclorama-projectors";

class MuseumChecker {
 public:
  MuseumChecker(const fs::path& folder, const SettingsCheck& how)
      : check_(folder, how),
        for_any_computer_(how.for_any_computer || check_.has(kAnyComputerFile)),
        sockets_(how.sockets) {}

  SettingsVerdict run() {
    check_site();
    check_attract_picture();
    check_installation();
    check_wands();
    check_calibrator();
    check_operator();
    check_care();
    query_programs();
    return std::move(check_.verdict());
  }

 private:
  bool is_there(const char* name) {
    if (check_.has(name)) return true;
    check_.problem(fmt::format("{} is missing; a museum's folder has site.toml and installation.toml", name));
    return false;
  }

  void check_site() {
    if (!is_there("site.toml")) return;
    const auto hours = read_opening_hours(check_.in("site.toml"));
    if (!hours) check_.problem(hours.error().message());
    const auto settings = tour::read_tour_settings(check_.in("site.toml"));
    if (!settings) {
      if (!hours && hours.error().message() == settings.error().message()) return;  // The mistake is reported once.
      return check_.problem(settings.error().message());
    }
    check_tour(settings->tour_folder);
    const auto update = update::read_update_settings(check_.in("site.toml"));
    if (!update && hours) check_.problem(update.error().message());
    check_network();
    check_.verdict().museum = settings->museum;
    check_.verdict().farm = settings->coordinators;
    bool is_far = false;
    for (const std::string& coordinator : settings->coordinators) {
      is_far = is_far || !is_loopback(coordinator);
      if (is_unix_socket(coordinator)) continue;
      const auto address = parse_address(coordinator);
      if (!address) check_.problem(fmt::format("site.toml [farm] coordinators: {}", address.error().message()));
    }
    if (settings->tls) {
      return check_.check_certificates(*settings->tls, Role::kMuseum, "site.toml [farm]", kTourGroup, "museum NAME");
    }
    if (is_far) {
      check_.remark(
          "site.toml names no certificate, so the link to the farm is not encrypted, and most farms refuse it; "
          "unpack the museum's bundle of cyclorama-authority beside it and name its files in [farm]");
    }
  }

  /// Checks [network], and the files of its login.
  void check_network() {
    const auto network = read_network_settings(check_.in("site.toml"));
    if (!network) return check_.problem(network.error().message());
    const PortLogin& login = network->login;
    const std::string where = "site.toml [network.login]";
    for (const std::string& file : {login.authority, login.certificate}) {
      if (!file.empty()) check_.is_ours(check_.folder() / file, where);
    }
    for (const std::string& secret : {login.password_file, login.key}) {
      if (!secret.empty() && check_.is_ours_unquoted(check_.folder() / secret, where))
        check_.keep_secret(check_.folder() / secret, kRootGroup);
    }
  }

  /// Checks the tour that [tour] names; only a visit can tell whether its stops are in the scene.
  void check_tour(const fs::path& folder) {
    if (folder.empty()) return;
    const tour::TourFolder curated(folder);
    if (!check_.is_ours(curated.file(), "site.toml [tour] folder")) return;
    const auto text = curated.read();
    const auto plan =
        text ? tour::parse_tour_plan(*text, curated.file().string()) : Result<tour::TourPlan>(text.error());
    if (!plan) check_.problem(plan.error().message());
  }

  /// Checks the files that [display] names; the display checks the table itself.
  void check_attract_picture() {
    auto config = Config::read(check_.in("site.toml"));
    if (!config) return;  // Reported already.
    const std::string picture = config->root().table("display").text("attract_picture", "");
    if (picture.empty() || !check_.is_ours(check_.folder() / picture, "site.toml [display] attract_picture")) return;
    const auto image = read_image(check_.folder() / picture, kPhotoLimitPx);
    if (!image) check_.problem(image.error().message());
  }

  void check_installation() {
    if (!is_there("installation.toml")) return;
    const auto installation = read_installation(check_.in("installation.toml"));
    if (!installation) return check_.problem(installation.error().message());
    check_.verdict().projectors = static_cast<int>(installation->projectors.size());
    if (const auto checked = check_connectors(*installation); !checked && !for_any_computer_) {
      check_.problem(fmt::format("installation.toml: {}. Connected to this computer now: {}", checked.error().message(),
                                 text_of_connected(list_sockets(sockets_))));
    }
    for (const InstalledProjector& projector : installation->projectors) {
      const std::string where = fmt::format("installation.toml: projector '{}'", printable(projector.name));
      if (projector.warp) {
        check_.is_ours(projector.warp->file, where);
        if (!projector.warp->mask.empty()) check_.is_ours(projector.warp->mask, where);
      }
      if (!projector.plug.edid.empty() && check_.is_ours(projector.plug.edid, where)) {
        const auto edid = read_edid_to_drive(projector.plug.edid);
        if (!edid) check_.problem(edid.error().message());
      }
      if (!projector.pjlink || projector.pjlink->password_file.empty()) continue;
      if (check_.is_ours_unquoted(projector.pjlink->password_file, where + " password_file"))
        check_.keep_secret(projector.pjlink->password_file, kProjectorsGroup);
    }
  }

  /// Checks the wands that tracker.toml names, and wand.toml in any case.
  void check_wands() {
    std::vector<fs::path> wands;
    if (check_.has("wand.toml")) wands.push_back(check_.in("wand.toml"));
    if (check_.has("tracker.toml")) {
      auto config = Config::read(check_.in("tracker.toml"));
      if (!config) return check_.problem(config.error().message());
      const std::vector<std::string> files = config->root().table("wand").texts("files", std::vector<std::string>{});
      for (const std::string& file : files) {
        if (check_.is_ours(check_.folder() / file, "tracker.toml [wand] files"))
          wands.push_back(check_.folder() / file);
      }
      if (files.empty() && !wands.empty()) {
        check_.remark(
            "wand.toml is there, but tracker.toml does not name it: write files = [\"wand.toml\"] in its [wand]");
      }
    } else {
      check_.remark(
          "tracker.toml is missing, so no camera follows the wand, and the visit is led by the guide or by keys");
    }
    std::sort(wands.begin(), wands.end());
    wands.erase(std::unique(wands.begin(), wands.end()), wands.end());
    for (const fs::path& wand : wands) {
      const auto read = read_wand(wand);
      if (!read) check_.problem(read.error().message());
    }
  }

  /// Checks the files that calibrator.toml names, and that cameras match lens files; the calibrator checks the rest.
  void check_calibrator() {
    std::vector<std::string> lenses;
    if (check_.has("calibrator.toml")) {
      auto config = Config::read(check_.in("calibrator.toml"));
      if (!config) return check_.problem(config.error().message());
      const std::string lens = config->root().table("camera").text("lens", "");
      if (!lens.empty()) check_.is_ours(check_.folder() / lens, "calibrator.toml [camera] lens");
      for (ConfigTable camera : config->root().table("watch").tables("camera")) {
        const std::string name = camera.text("name", "");
        lenses.push_back(name + ".json");
        if (name.empty() || check_.has("cameras/" + lenses.back())) continue;
        check_.remark(
            fmt::format("cameras/{0}.json is missing: if this computer's calibration does not know its lens, camera "
                        "'{0}' of calibrator.toml watches nothing; let 'cyclorama calibrate-camera' measure it, and "
                        "copy what that writes",
                        printable(name)));
      }
    }
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(check_.in("cameras"), ignored)) {
      const std::string file = entry.path().filename().string();
      if (std::find(lenses.begin(), lenses.end(), file) != lenses.end()) continue;
      check_.remark(fmt::format("cameras/{} is there, but calibrator.toml has no [[watch.camera]] of that name",
                                printable(file)));
    }
  }

  void check_operator() {
    if (!check_.has(kOperatorFile)) {
      if (check_.has(kPinFile)) return;
      return check_.remark(
          "operator.toml is missing, so the operator page has no PIN and answers on this computer alone");
    }
    const auto text = read_text_file(check_.in(kOperatorFile), kMaxTextBytes);
    if (!text) return check_.problem(text.error().message());
    auto settings = parse_operator_settings(*text, kOperatorFile);
    if (!settings) return check_.problem(settings.error().message());
    check_.verdict().pin = std::move(settings->pin);
  }

  void check_care() {
    const auto care = care::read_care_settings(check_.in(care::kCareFile));
    if (!care) return check_.problem(care.error().message());
    const auto secret = [&](const fs::path& file, const std::string& where, std::size_t min_length = 1) {
      if (file.empty() || !check_.is_ours_unquoted(file, where)) return;
      check_.keep_secret(file, kOperatorGroup);
      const auto read = care::read_secret(file);
      if (!read) return check_.problem(read.error().message());
      if (read->size() < min_length)
        check_.problem(fmt::format("{}: its token must have {} characters or more", where, min_length));
    };
    const auto authority = [&](const fs::path& file, const std::string& where) {
      if (!file.empty()) check_.is_ours(file, where);
    };
    if (const auto& mail = care->alarms.mail) {
      secret(mail->password_file, "care.toml [alarms.mail] password_file");
      authority(mail->authority, "care.toml [alarms.mail] authority");
    }
    if (const auto& webhook = care->alarms.webhook) {
      secret(webhook->token_file, "care.toml [alarms.webhook] token_file");
      authority(webhook->authority, "care.toml [alarms.webhook] authority");
    }
    secret(care->metrics_token_file, "care.toml [metrics] token_file", care::kMinMetricsToken);
  }

  void query_programs() {
    check_.ask({"cyclorama-display", "--check", "--config", check_.in("site.toml").string(), "--installation",
                check_.in("installation.toml").string(), "--tour", "[::1]:7403"});
    if (check_.has("tracker.toml")) {
      check_.ask({"cyclorama-tracker", "--check", "--config", check_.in("tracker.toml").string()});
    }
    if (check_.has("calibrator.toml")) {
      check_.ask({"cyclorama-calibrator", "--check", "--config", check_.in("calibrator.toml").string(),
                  "--installation", check_.in("installation.toml").string()});
    }
  }

  FolderCheck check_;
  bool for_any_computer_;
  fs::path sockets_;
};

}  // namespace

SettingsVerdict check_settings(const fs::path& folder, const SettingsCheck& how) {
  return how.of == SettingsOf::kFarmHost ? check_farm_host(folder, how) : MuseumChecker(folder, how).run();
}

}  // namespace cyclorama::provision
