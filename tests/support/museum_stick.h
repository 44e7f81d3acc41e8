// SPDX-License-Identifier: Apache-2.0
/// A folder like a museum's USB stick, valid until a test damages it, and a folder for the installed settings.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/base/file.h"
#include "common/image/image.h"
#include "common/image/png.h"
#include "kiosk/provision/provision.h"
#include "tests/support/test_authority.h"

namespace cyclorama {

inline constexpr const char* kStickPin = "401773";

/// Returns the authority, and certificates, that all tests of a program share, because making them takes seconds.
inline TestAuthority& museum_authority() {
  static TestAuthority authority;
  return authority;
}
inline const TlsFiles& museum_certificates() {
  static const TlsFiles files = museum_authority().museum("hall-3");
  return files;
}

class MuseumStick {
 public:
  MuseumStick() {
    std::string folder = (std::filesystem::temp_directory_path() / "stick-XXXXXX").string();
    EXPECT_NE(::mkdtemp(folder.data()), nullptr);
    place_ = folder;
    std::filesystem::create_directories(stick() / "tls");
    std::filesystem::create_directories(root());
    write("site.toml", site());
    const char* const source = std::getenv("CYCLORAMA_SOURCE");
    write("installation.toml", room(std::filesystem::path(source != nullptr ? source : ".") / "demo"));
    write("tracker.toml", "[camera]\nkind = \"v4l2\"\nport = \"usb-0000:00:14.0-2\"\n");
    write("operator.toml", std::string("pin = \"") + kStickPin + "\"\n");
    RgbImage picture(8, 4);
    picture.at(3, 2)[0] = 200;
    EXPECT_TRUE(write_png(stick() / "evening.png", picture));
    const TlsFiles& tls = museum_certificates();
    std::filesystem::copy_file(tls.authority, stick() / "tls" / "authority.crt");
    std::filesystem::copy_file(tls.certificate, stick() / "tls" / "certificate.crt");
    std::filesystem::copy_file(tls.key, stick() / "tls" / "key.pem");
  }
  ~MuseumStick() { std::filesystem::remove_all(place_); }
  MuseumStick(const MuseumStick&) = delete;
  MuseumStick& operator=(const MuseumStick&) = delete;

  static std::string site(const std::string& museum = "hall-3") {
    return "[farm]\ncoordinators = [\"[2001:db8::1]:7401\"]\nmuseum = \"" + museum +
           "\"\nauthority = \"tls/authority.crt\"\ncertificate = \"tls/certificate.crt\"\nkey = \"tls/key.pem\"\n"
           "[display]\nattract_picture = \"evening.png\"\n[hours]\nopen = [\"Tue-Sun 10:00-18:00\"]\n";
  }
  /// Returns the demo's room with a connector for each projector.
  static std::string room(const std::filesystem::path& demo) {
    auto text = read_text_file(demo / "installation.toml", 1 << 20);
    EXPECT_TRUE(text);
    constexpr std::string_view kProjector = "[[projector]]\n";
    int number = 0;
    for (std::size_t at = 0; (at = text->find(kProjector, at)) != std::string::npos; at += kProjector.size())
      text->insert(at + kProjector.size(), "connector = \"HDMI-A-" + std::to_string(++number) + "\"\n");
    return *text;
  }
  void write(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file_atomically(stick() / name, std::string_view(text)));
  }
  void remove(const std::string& name) const { std::filesystem::remove_all(stick() / name); }

  [[nodiscard]] std::filesystem::path stick() const { return place_ / "stick"; }
  [[nodiscard]] std::filesystem::path root() const { return place_ / "state"; }
  [[nodiscard]] std::string in_use(const std::string& name) const {
    const auto text = read_text_file(root() / "settings" / name, 1 << 20);
    return text ? *text : "";
  }
  /// Installs the stick. CHECKs only errors of the machine; all others are in the report.
  [[nodiscard]] provision::ProvisioningReport install(provision::StepHook hook = {},
                                                      const provision::FolderLimits& limits = {}) const {
    auto store = provision::SettingsStore::open(root(), std::move(hook));
    CHECK(store);
    auto report = provision::provision({stick(), {}, limits, false, "2026-11-22T16:04:05Z"}, &*store);
    CHECK(report);
    return *std::move(report);
  }

 private:
  std::filesystem::path place_;
};

}  // namespace cyclorama
