// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <limits>

#include "common/base/file.h"
#include "kiosk/provision/provision.h"
#include "tests/support/test_authority.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kCoordinator =
    "museums = \"[::]:7401\"\nnodes = \"[::]:7402\"\n[[scene]]\nname = \"cave\"\npath = \"/etc/cyclorama/cave\"\non = "
    "\"coordinator\"\n[tls]\nauthority = \"tls-coordinator/authority.crt\"\ncertificate = "
    "\"tls-coordinator/certificate.crt\"\nkey = "
    "\"tls-coordinator/key.pem\"\n";
constexpr const char* kNode =
    "coordinators = [\"[2001:db8::1]:7402\"]\n[tls]\nauthority = \"tls-node/authority.crt\"\ncertificate = "
    "\"tls-node/certificate.crt\"\nkey = \"tls-node/key.pem\"\n";

/// Shared by all tests, since it takes seconds to make.
TestAuthority& authority() {
  static TestAuthority made;
  return made;
}
const TlsFiles& coordinator_certificates() {
  static const TlsFiles files = authority().coordinator();
  return files;
}
const TlsFiles& node_certificates() {
  static const TlsFiles files = authority().node("n1");
  return files;
}

/// A render host's USB stick: coordinator, node, and a scene of the coordinator.
class FarmStick {
 public:
  FarmStick() {
    std::string folder = (fs::temp_directory_path() / "farm-stick-XXXXXX").string();
    EXPECT_NE(::mkdtemp(folder.data()), nullptr);
    place_ = folder;
    fs::create_directories(place_ / "state");
    for (const char* const inner : {"cave", "tls-coordinator", "tls-node"}) fs::create_directories(stick() / inner);
    write("farm.toml", kCoordinator);
    write("node.toml", kNode);
    write("cave/scene.toml", "title = \"Cave\"\n");
    copy(coordinator_certificates(), "tls-coordinator");
    copy(node_certificates(), "tls-node");
  }
  ~FarmStick() { fs::remove_all(place_); }
  FarmStick(const FarmStick&) = delete;
  FarmStick& operator=(const FarmStick&) = delete;

  [[nodiscard]] fs::path stick() const { return place_ / "stick"; }
  [[nodiscard]] fs::path settings() const { return place_ / "state" / "settings"; }
  void write(const std::string& name, const std::string& text) const {
    EXPECT_TRUE(write_file_atomically(stick() / name, std::string_view(text)));
  }
  void remove(const std::string& name) const { fs::remove_all(stick() / name); }
  void copy(const TlsFiles& files, const std::string& to) const {
    for (const fs::path& file : {files.authority, files.certificate, files.key}) {
      fs::copy_file(file, stick() / to / file.filename(), fs::copy_options::overwrite_existing);
    }
  }
  [[nodiscard]] ProvisioningReport install(const fs::path& programs = {}) const {
    auto store = SettingsStore::open(place_ / "state");
    CHECK(store);
    auto report = provision({stick(), {programs, SettingsOf::kFarmHost}, {}, false, "2026-11-23T04:00:00Z"}, &*store);
    CHECK(report);
    return *std::move(report);
  }

 private:
  fs::path place_;
};

TEST(FarmHost, takes_coordinator_node_and_a_scene_from_one_usb_stick) {
  const FarmStick host;
  const ProvisioningReport report = host.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kInstalled) << report_json(report);
  EXPECT_THAT(report.farm, ElementsAre("[2001:db8::1]:7402"));
  EXPECT_EQ(report.certificate_until.size(), 10u);
  EXPECT_TRUE(fs::exists(host.settings() / "cave" / "scene.toml"));
  for (const char* const secret : {"tls-coordinator/key.pem", "tls-node/key.pem"}) {
    struct stat info {};
    ASSERT_EQ(::stat((host.settings() / secret).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0007, 0u) << secret << " is for all to read";
  }
}

TEST(FarmHost, may_be_a_coordinator_or_a_node_alone) {
  const FarmStick host;
  host.remove("node.toml");
  EXPECT_EQ(host.install().verdict, ProvisioningVerdict::kInstalled);
  host.write("node.toml", kNode);
  host.remove("farm.toml");
  EXPECT_EQ(host.install().verdict, ProvisioningVerdict::kInstalled);
  EXPECT_FALSE(fs::exists(host.settings() / "farm.toml")) << "what is not on the stick is not in use any more";
}

TEST(FarmHost, cannot_be_a_museum_and_a_museum_cannot_be_a_render_host) {
  const FarmStick host;
  host.write("site.toml", "");
  EXPECT_THAT(host.install().problems, Contains(HasSubstr("site.toml is a museum's")));
  host.remove("site.toml");
  auto store = SettingsStore::open(host.settings().parent_path());
  ASSERT_TRUE(store);
  const auto report = provision({host.stick(), {}, {}, false, ""}, &*store);
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, Contains(HasSubstr("site.toml is missing")));
}

struct Spoilt {
  const char* name;
  void (*spoil)(const FarmStick&);
  const char* says;
};
class BadFarmStick : public testing::TestWithParam<Spoilt> {};

TEST_P(BadFarmStick, is_refused_with_a_reason) {
  const FarmStick host;
  GetParam().spoil(host);
  const ProvisioningReport report = host.install();
  EXPECT_EQ(report.verdict, ProvisioningVerdict::kRefused);
  EXPECT_THAT(report.problems, ElementsAre(HasSubstr(GetParam().says))) << report_json(report);
  EXPECT_FALSE(fs::exists(host.settings()));
}

INSTANTIATE_TEST_SUITE_P(
    Ways, BadFarmStick,
    testing::Values(
        Spoilt{"nothing",
               [](const FarmStick& s) {
                 s.remove("farm.toml");
                 s.remove("node.toml");
               },
               "neither farm.toml nor node.toml"},
        Spoilt{"head_cut", [](const FarmStick& s) { s.write("farm.toml", "museums = \"[:"); }, "farm.toml:1"},
        Spoilt{"node_cut", [](const FarmStick& s) { s.write("node.toml", "coordinators = [\"[20"); }, "node.toml:1"},
        Spoilt{"key_missing", [](const FarmStick& s) { s.remove("tls-node/key.pem"); },
               "'tls-node/key.pem', which is not there"},
        Spoilt{"certificates_elsewhere",
               [](const FarmStick& s) {
                 s.write("node.toml",
                         "[tls]\nauthority = \"tls-node/authority.crt\"\ncertificate = \"tls-node/certificate.crt\"\n"
                         "key = \"../key.pem\"\n");
               },
               "which is not in the folder"},
        Spoilt{"head_with_a_nodes_certificate",
               [](const FarmStick& s) { s.copy(node_certificates(), "tls-coordinator"); }, "a coordinator needs one"},
        Spoilt{"node_with_a_heads_certificate",
               [](const FarmStick& s) { s.copy(coordinator_certificates(), "tls-node"); }, "a node needs one"},
        Spoilt{"scene_missing", [](const FarmStick& s) { s.remove("cave"); }, "scene 'cave' lies at"},
        Spoilt{"scene_beyond",
               [](const FarmStick& s) {
                 s.write("farm.toml",
                         std::string(kCoordinator).replace(std::string(kCoordinator).find("cave\"\non"), 4, "../no"));
               },
               "which is not there"},
        Spoilt{
            "grants_missing",
            [](const FarmStick& s) { s.write("farm.toml", std::string("museums_file = \"m.toml\"\n") + kCoordinator); },
            "'m.toml', which is not there"},
        Spoilt{"token_missing",
               [](const FarmStick& s) {
                 s.write("farm.toml", std::string(kCoordinator) + "[watch]\ntoken_file = \"t\"\n");
               },
               "'t', which is not there"}),
    [](const auto& test) { return test.param.name; });

TEST(FarmHost, keeps_room_for_what_runs_and_updates_only_settings_on_a_full_disk) {
  constexpr std::uintmax_t kMiB = 1 << 20;
  const FolderLimits max{200, 4096 * kMiB, 16384 * kMiB};
  EXPECT_EQ(within(std::numeric_limits<std::uintmax_t>::max(), max).max_bytes, max.max_bytes);
  EXPECT_EQ(within(1256 * kMiB, max).max_bytes, 1000 * kMiB);
  for (const std::uintmax_t full : {257 * kMiB, 256 * kMiB, 255 * kMiB, kMiB, std::uintmax_t{0}}) {
    EXPECT_EQ(within(full, max).max_bytes, kMiB) << full;
  }
  EXPECT_EQ(within(0, max).max_files, max.max_files);
  EXPECT_EQ(within(0, {200, 10, 10}).max_bytes, 10U);
}

TEST(FarmHost, checks_settings_by_the_programs_themselves) {
  const FarmStick host;
  const fs::path programs = host.settings().parent_path() / "bin";
  fs::create_directories(programs);
  const auto program = [&](const char* name, const char* script) {
    EXPECT_TRUE(write_file_atomically(programs / name, std::string_view(script)));
    fs::permissions(programs / name, fs::perms::owner_all);
  };
  program("cyclorama-farm", "#!/bin/sh\ntest \"$1\" = --check\n");
  program("cyclorama-node", "#!/bin/sh\necho \"<3>${3}:1: threads: is too many\" >&2\nexit 1\n");
  EXPECT_THAT(host.install(programs).problems,
              ElementsAre("cyclorama-node refuses them: node.toml:1: threads: is too many"));
  program("cyclorama-node", "#!/bin/sh\nexit 0\n");
  EXPECT_THAT(host.install(programs).problems, IsEmpty());
}

}  // namespace
}  // namespace cyclorama::provision
