// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <system_error>

#include "common/base/text.h"
#include "common/config/config.h"
#include "kiosk/provision/folder_check.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

/// Folder of the settings in use, and of the scenes that a USB stick brought with them.
constexpr const char* kInUse = "/etc/cyclorama";

class FarmHostChecker {
 public:
  FarmHostChecker(const fs::path& folder, const SettingsCheck& how) : check_(folder, how) {}

  SettingsVerdict run() {
    const bool is_head = check_.has("farm.toml");
    const bool is_node = check_.has("node.toml");
    if (!is_head && !is_node) {
      check_.problem(
          "neither farm.toml nor node.toml is there; a render host's folder has the one, the other, or both");
    }
    if (check_.has("site.toml")) {
      check_.problem("site.toml is a museum's, and this is a render host; take it away, or plug the stick in there");
    }
    if (is_head) check_head();
    if (is_node) check_node();
    if (is_head) check_.ask({"cyclorama-farm", "--check", "--config", check_.in("farm.toml").string()});
    if (is_node) check_.ask({"cyclorama-node", "--check", "--config", check_.in("node.toml").string()});
    return std::move(check_.verdict());
  }

 private:
  [[nodiscard]] TlsFiles tls_of(ConfigTable& tls) const {
    const auto file = [&](const char* key) { return check_.in(tls.text(key, "")); };
    return {file("authority"), file("certificate"), file("key")};
  }
  /// Checks an optional file: that it exists and, if secret, that its service can read it.
  void check_file(const std::string& name, const std::string& where, const char* secret_of = nullptr) {
    if (name.empty() || !check_.is_ours(check_.in(name), where) || secret_of == nullptr) return;
    check_.keep_secret(check_.in(name), secret_of);
  }

  /// Checks the files that farm.toml names; cyclorama-farm checks farm.toml itself.
  void check_head() {
    constexpr const char* kGroup = "cyclorama-farm";
    auto config = Config::read(check_.in("farm.toml"));
    if (!config) return check_.problem(config.error().message());
    ConfigTable root = config->root();
    check_file(root.text("museums_file", ""), "farm.toml museums_file", kGroup);  // Holds the keys of watermarks.
    if (root.has("tls")) {
      ConfigTable tls = root.table("tls");
      check_.check_certificates(tls_of(tls), Role::kCoordinator, "farm.toml [tls]", kGroup, "coordinator NAME");
      check_file(tls.text("revoked", ""), "farm.toml [tls] revoked");
    }
    if (root.has("watch")) {
      check_file(root.table("watch").text("token_file", ""), "farm.toml [watch] token_file", kGroup);
    }
    for (ConfigTable& scene : root.tables("scene")) {
      if (scene.text("on", "nodes") == "coordinator") check_scene(scene.text("name", ""), scene.text("path", ""));
    }
  }

  void check_scene(const std::string& name, const fs::path& path) {
    const fs::path within = path.lexically_normal().lexically_relative(kInUse);
    const bool is_brought = !within.empty() && *within.begin() != "..";
    std::error_code failed;
    if (path.empty() || fs::exists(is_brought ? check_.in(within.string()) : path, failed)) return;
    check_.problem(fmt::format(
        "farm.toml: scene '{}' lies at '{}', which is not there; put its folder beside farm.toml, and write path = "
        "\"{}/FOLDER\"",
        printable(name), printable(path.string(), 200), kInUse));
  }

  void check_node() {
    auto config = Config::read(check_.in("node.toml"));
    if (!config) return check_.problem(config.error().message());
    ConfigTable root = config->root();
    check_.verdict().farm = root.texts("coordinators", std::vector<std::string>{});
    if (!root.has("tls")) return;
    ConfigTable tls = root.table("tls");
    check_.check_certificates(tls_of(tls), Role::kNode, "node.toml [tls]", "cyclorama-node", "node NAME");
  }

  FolderCheck check_;
};

}  // namespace

SettingsVerdict check_farm_host(const fs::path& folder, const SettingsCheck& how) {
  return FarmHostChecker(folder, how).run();
}

}  // namespace cyclorama::provision
