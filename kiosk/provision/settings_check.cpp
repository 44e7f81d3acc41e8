// SPDX-License-Identifier: Apache-2.0
#include "kiosk/provision/settings_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "common/base/address.h"
#include "common/base/file.h"
#include "common/base/text.h"
#include "common/config/config.h"
#include "common/image/image_file.h"
#include "common/opening/opening_hours.h"
#include "common/process/child.h"
#include "common/room/installation.h"
#include "common/wand/wand.h"
#include "common/wire/openssl.h"
#include "common/wire/tls.h"
#include "kiosk/provision/operator_settings.h"
#include "kiosk/tour/session/tour_settings.h"

namespace cyclorama {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestText = 1 << 20;
constexpr const char* kTourGroup = "cyclorama-tour";
constexpr const char* kProjectorsGroup = "cyclorama-projectors";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(path, ignored));
}

class Checker {
 public:
  Checker(const fs::path& folder, const SettingsCheck& how) : folder_(folder.lexically_normal()), how_(how) {}

  SettingsVerdict run() {
    check_site();
    check_attract_picture();
    check_installation();
    check_wands();
    check_operator();
    ask_programs();
    return std::move(verdict_);
  }

 private:
  [[nodiscard]] fs::path in(const char* name) const { return folder_ / name; }

  /// Where the folder lies for now is nothing to the reader: "site.toml:7: ...".
  [[nodiscard]] std::string without_folder(std::string text) const {
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) text.erase(at, prefix.size());
    return text;
  }
  void problem(const std::string& text) { verdict_.problems.push_back(without_folder(text)); }
  void remark(const std::string& text) { verdict_.remarks.push_back(without_folder(text)); }

  /// That a path from a setting leads to a file of this folder.
  bool is_ours(const fs::path& path, const std::string& where) {
    const fs::path within = path.lexically_normal().lexically_relative(folder_);
    if (within.empty() || within.is_absolute() || *within.begin() == "..") {
      problem(
          fmt::format("{} names '{}', which is not in the folder; put it beside site.toml and name it without a path",
                      where, printable(path.string(), 200)));
      return false;
    }
    if (is_file(path)) return true;
    problem(fmt::format("{} names '{}', which is not there; copy it too", where, within.string()));
    return false;
  }
  void keep_secret(const fs::path& path, const char* group) {
    verdict_.secrets.push_back({path.lexically_normal().lexically_relative(folder_), group});
  }
  bool is_there(const char* name) {
    if (is_file(in(name))) return true;
    problem(fmt::format("{} is missing; a museum's folder has site.toml and installation.toml", name));
    return false;
  }

  void check_site() {
    if (!is_there("site.toml")) return;
    const auto hours = read_opening_hours(in("site.toml"));
    if (!hours) problem(hours.error().message());
    const auto settings = read_tour_settings(in("site.toml"));
    if (!settings) {
      if (!hours && hours.error().message() == settings.error().message()) return;  // One mistake, said once.
      return problem(settings.error().message());
    }
    verdict_.museum = settings->museum;
    verdict_.farm = settings->heads;
    bool is_far = false;
    for (const std::string& head : settings->heads) {
      is_far = is_far || !is_loopback(head);
      if (is_unix_socket(head)) continue;
      const auto address = parse_address(head);
      if (!address) problem(fmt::format("site.toml [farm] heads: {}", address.error().message()));
    }
    if (settings->tls) return check_certificates(*settings->tls);
    if (is_far) {
      remark(
          "site.toml names no certificate, so the link to the farm is not encrypted, and most farms refuse it; "
          "unpack the museum's bundle of cyclorama-authority beside it and name its files in [farm]");
    }
  }

  void check_certificates(const TlsFiles& files) {
    bool all = is_ours(files.authority, "site.toml [farm] authority");
    all = is_ours(files.certificate, "site.toml [farm] certificate") && all;
    all = is_ours(files.key, "site.toml [farm] key") && all;
    if (!all) return;
    keep_secret(files.key, kTourGroup);
    const auto owner = check(files);
    if (!owner) return problem(owner.error().message());
    if (owner->role != Role::kMuseum) {
      return problem(
          fmt::format("'{}' is the certificate of {}; a museum needs one that cyclorama-authority made with "
                      "'museum NAME'",
                      files.certificate.string(), to_text(*owner)));
    }
    const auto pem = read_text_file(files.certificate, kLargestText);
    if (!pem) return problem(pem.error().message());
    const auto certificate = parse_certificate(*pem);
    if (certificate) verdict_.certificate_until = day_text(X509_get0_notAfter(certificate->get()));
  }

  /// [display] is the display's to read; here only what it names.
  void check_attract_picture() {
    auto config = Config::read(in("site.toml"));
    if (!config) return;  // Said already.
    const std::string picture = config->root().table("display").text("attract_picture", "");
    if (picture.empty() || !is_ours(folder_ / picture, "site.toml [display] attract_picture")) return;
    const auto image = read_image(folder_ / picture, kPhotoLimitPx);
    if (!image) problem(image.error().message());
  }

  void check_installation() {
    if (!is_there("installation.toml")) return;
    const auto installation = read_installation(in("installation.toml"));
    if (!installation) return problem(installation.error().message());
    verdict_.projectors = static_cast<int>(installation->projectors.size());
    for (const InstalledProjector& projector : installation->projectors) {
      const std::string where = fmt::format("installation.toml: projector '{}'", printable(projector.name));
      if (projector.warp) {
        is_ours(projector.warp->file, where);
        if (!projector.warp->mask.empty()) is_ours(projector.warp->mask, where);
      }
      if (!projector.pjlink || projector.pjlink->password_file.empty()) continue;
      if (is_ours(projector.pjlink->password_file, where))
        keep_secret(projector.pjlink->password_file, kProjectorsGroup);
    }
  }

  /// Those that tracker.toml names, and wand.toml in any case.
  void check_wands() {
    std::vector<fs::path> wands;
    if (is_file(in("wand.toml"))) wands.push_back(in("wand.toml"));
    if (is_file(in("tracker.toml"))) {
      auto config = Config::read(in("tracker.toml"));
      if (!config) return problem(config.error().message());
      const std::vector<std::string> files = config->root().table("wand").texts("files", std::vector<std::string>{});
      for (const std::string& file : files) {
        if (is_ours(folder_ / file, "tracker.toml [wand] files")) wands.push_back(folder_ / file);
      }
      if (files.empty() && !wands.empty()) {
        remark("wand.toml is there, but tracker.toml does not name it: write files = [\"wand.toml\"] in its [wand]");
      }
    } else {
      remark("tracker.toml is missing, so no camera follows the wand, and the visit is led by the guide or by keys");
    }
    std::sort(wands.begin(), wands.end());
    wands.erase(std::unique(wands.begin(), wands.end()), wands.end());
    for (const fs::path& wand : wands) {
      const auto read = read_wand(wand);
      if (!read) problem(read.error().message());
    }
  }

  void check_operator() {
    if (!is_file(in(kOperatorFile))) {
      return remark("operator.toml is missing, so the operator page has no PIN and answers on this computer alone");
    }
    const auto text = read_text_file(in(kOperatorFile), kLargestText);
    if (!text) return problem(text.error().message());
    auto settings = parse_operator_settings(*text, kOperatorFile);
    if (!settings) return problem(settings.error().message());
    verdict_.pin = std::move(settings->pin);
  }

  /// Each reads its settings as it would at its start, and says what it makes of them.
  void ask_programs() {
    if (how_.programs.empty() || !verdict_.problems.empty()) return;
    ask({"cyclorama-display", "--check", "--config", in("site.toml").string(), "--installation",
         in("installation.toml").string(), "--tour", "[::1]:7403"});
    if (is_file(in("tracker.toml"))) ask({"cyclorama-tracker", "--check", "--config", in("tracker.toml").string()});
  }
  void ask(std::vector<std::string> command) {
    const std::string name = command.front();
    command.front() = (how_.programs / name).string();
    const auto end = run_child(command);
    if (!end) return problem(end.error().message());
    if (end->exit_code == 0) return;
    // Its last line says why.
    std::string said = end->output;
    while (!said.empty() && said.back() == '\n') said.pop_back();
    said.erase(0, said.rfind('\n') + 1);
    if (said.starts_with("<") && said.find('>') == 2) said.erase(0, 3);  // The journal's mark.
    problem(fmt::format("{} refuses them: {}", name, printable(without_folder(said), 1000)));
  }

  const fs::path folder_;
  const SettingsCheck how_;
  SettingsVerdict verdict_;
};

}  // namespace

SettingsVerdict check_settings(const fs::path& folder, const SettingsCheck& how) { return Checker(folder, how).run(); }

}  // namespace cyclorama
