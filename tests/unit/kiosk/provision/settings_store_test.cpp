// SPDX-License-Identifier: Apache-2.0
/// Tests in which the power fails, or the disk is full, at every step.
#include "kiosk/provision/settings_store.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdio>
#include <functional>

#include "tests/support/museum_stick.h"

namespace cyclorama::provision {
namespace {

namespace fs = std::filesystem;

constexpr int kPowerCut = 77;

/// Returns the exit code of a child process that does the work.
int in_a_child(const std::function<int()>& work) {
  const pid_t pid = ::fork();
  if (pid == 0) ::_exit(work());
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Exits at the given step, as if the power had failed; returns 0 if there are fewer steps.
int install_until(const MuseumStick& museum, int last_step) {
  return in_a_child([&] {
    int steps = 0;
    const ProvisioningReport report = museum.install([&](std::string_view) {
      if (++steps == last_step) ::_exit(kPowerCut);
    });
    return report.verdict == ProvisioningVerdict::kInstalled ? 0 : 1;
  });
}

/// Expects all files in use to belong to one set.
void expect_whole(const MuseumStick& museum, const std::string& where) {
  auto store = SettingsStore::open(museum.root());
  ASSERT_TRUE(store) << where;
  const std::vector<CopiedFile> files = store->contents();
  ASSERT_FALSE(files.empty()) << where;
  for (const CopiedFile& file : files) {
    const auto text = read_text_file(store->settings() / file.name, 1 << 24);
    ASSERT_TRUE(text) << where << ": " << file.name;
    const auto sha256 = sha256_of(*text);
    ASSERT_TRUE(sha256);
    EXPECT_EQ(*sha256, file.sha256) << where << ": " << file.name;
  }
}

TEST(SettingsStore, has_one_complete_set_in_use_whenever_the_power_fails) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  int cuts = 0;
  int old_ones = 0;
  for (int step = 1;; ++step) {
    const std::string museum_name = "hall-" + std::to_string(100 + step);
    const std::string before = museum.in_use("site.toml");
    museum.write("site.toml", MuseumStick::site(museum_name));
    const int end = install_until(museum, step);
    if (end == 0) break;
    ASSERT_EQ(end, kPowerCut);
    ++cuts;
    expect_whole(museum, "cut at step " + std::to_string(step));
    const std::string now = museum.in_use("site.toml");
    EXPECT_TRUE(now == before || now == MuseumStick::site(museum_name)) << "neither the old nor the new";
    old_ones += now == before ? 1 : 0;
    // The next attempt succeeds whatever the power cut left.
    const ProvisioningReport again = museum.install();
    EXPECT_EQ(again.verdict, now == before ? ProvisioningVerdict::kInstalled : ProvisioningVerdict::kUnchanged);
    EXPECT_EQ(museum.in_use("site.toml"), MuseumStick::site(museum_name));
    // The previous settings are still there.
    auto store = SettingsStore::open(museum.root());
    ASSERT_TRUE(store);
    ASSERT_TRUE(store->restore());
    EXPECT_EQ(museum.in_use("site.toml"), before);
  }
  EXPECT_GE(cuts, 9);
  EXPECT_GT(old_ones, 0);
  EXPECT_LT(old_ones, cuts) << "some cuts come after the new ones are in use";
}

TEST(SettingsStore, survives_power_cuts_while_it_restores_settings) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  museum.write("site.toml", MuseumStick::site("hall-4"));
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  for (int step = 1;; ++step) {
    const std::string before = museum.in_use("site.toml");
    const int end = in_a_child([&] {
      int steps = 0;
      auto store = SettingsStore::open(museum.root(), [&](std::string_view) {
        if (++steps == step) ::_exit(kPowerCut);
      });
      return store && store->restore() ? 0 : 1;
    });
    if (end == 0) break;
    ASSERT_EQ(end, kPowerCut);
    expect_whole(museum, "cut at step " + std::to_string(step));
    const std::string other = before == MuseumStick::site() ? MuseumStick::site("hall-4") : MuseumStick::site();
    EXPECT_TRUE(museum.in_use("site.toml") == before || museum.in_use("site.toml") == other);
    auto store = SettingsStore::open(museum.root());
    ASSERT_TRUE(store);
    EXPECT_TRUE(store->restore()) << "the other one is still there after step " << step;
  }
}

TEST(SettingsStore, keeps_the_old_settings_when_a_file_cannot_be_written) {
  const MuseumStick museum;
  ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  museum.write("site.toml", MuseumStick::site("hall-4"));
  museum.write("relief.obj", std::string(40'000, 'v'));
  for (const rlim_t bytes : {rlim_t{0}, rlim_t{100}, rlim_t{4096}, rlim_t{20'000}}) {
    const int end = in_a_child([&] {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{bytes, bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      auto store = SettingsStore::open(museum.root());
      if (!store) return 1;
      const auto report = provision({museum.stick(), {}, {}, false, ""}, &*store);
      return !report && report.error().message().find("no room") != std::string::npos ? 0 : 2;
    });
    EXPECT_EQ(end, 0) << "with at most " << bytes << " bytes a file";
    EXPECT_EQ(museum.in_use("site.toml"), MuseumStick::site());
    expect_whole(museum, "without room");
    EXPECT_FALSE(fs::exists(museum.root() / "staging")) << "it makes room again";
  }
}

/// Returns true if this process may mount: as root, or as root of a user namespace.
bool has_own_mounts() {
  if (::unshare(CLONE_NEWNS) == 0) return true;
  const std::string map = "0 " + std::to_string(::geteuid()) + " 1";
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  std::FILE* const file = std::fopen("/proc/self/uid_map", "we");
  if (file == nullptr) return false;
  const bool is_written = std::fputs(map.c_str(), file) >= 0;
  return std::fclose(file) == 0 && is_written;
}

/// Needs permission to mount a disk of its own.
TEST(SettingsStore, keeps_the_old_settings_on_a_full_disk) {
  const MuseumStick museum;
  const std::string size = "size=256k,nr_inodes=200";
  constexpr int kNotAllowed = 70;
  const int end = in_a_child([&] {
    if (!has_own_mounts()) return kNotAllowed;
    if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return kNotAllowed;
    if (::mount("disk", museum.root().c_str(), "tmpfs", 0, size.c_str()) != 0) return kNotAllowed;
    if (museum.install().verdict != ProvisioningVerdict::kInstalled) return 1;
    museum.write("relief.obj", std::string(300'000, 'v'));
    auto store = SettingsStore::open(museum.root());
    if (!store) return 2;
    const auto report = provision({museum.stick(), {}, {}, false, ""}, &*store);
    if (report || report.error().message().find("no room") == std::string::npos) return 3;
    if (museum.in_use("site.toml") != MuseumStick::site()) return 4;
    museum.remove("relief.obj");
    museum.write("site.toml", MuseumStick::site("hall-4"));
    const auto again = provision({museum.stick(), {}, {}, false, ""}, &*store);
    return again && again->verdict == ProvisioningVerdict::kInstalled ? 0 : 5;
  });
  if (end == kNotAllowed) GTEST_SKIP() << "this user may not mount a small disk";
  EXPECT_EQ(end, 0);
}

TEST(SettingsStore, is_locked_by_one_program_at_a_time) {
  const MuseumStick museum;
  const auto one = SettingsStore::open(museum.root());
  ASSERT_TRUE(one);
  const auto two = SettingsStore::open(museum.root());
  ASSERT_FALSE(two);
  EXPECT_EQ(two.error().code(), ErrorCode::kBusy);
}

TEST(SettingsStore, keeps_two_sets_only) {
  const MuseumStick museum;
  for (int i = 0; i < 5; ++i) {
    museum.write("site.toml", MuseumStick::site("hall-" + std::to_string(i)));
    ASSERT_EQ(museum.install().verdict, ProvisioningVerdict::kInstalled);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(museum.root() / "generations"), fs::directory_iterator()), 2);
}

TEST(Checksums, are_read_in_the_format_of_sha256sum) {
  const std::string hash(64, 'a');
  const auto files = parse_checksums(hash + "  site.toml\n" + hash + " *./tls/key.pem\r\n\n");
  ASSERT_TRUE(files);
  ASSERT_EQ(files->size(), 2u);
  EXPECT_EQ((*files)[1].name, "tls/key.pem");
  for (const std::string& bad :
       {hash + "  ../x", hash + "  /etc/passwd", hash + "  a/b/c", hash + "  a\n" + hash + "  a",
        hash.substr(1) + "  ab", hash + "x  a", hash + "  .hidden"}) {
    EXPECT_FALSE(parse_checksums(bad)) << bad;
  }
}

}  // namespace
}  // namespace cyclorama::provision
