// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/checks.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <ctime>

#include "common/base/file.h"
#include "kiosk/operator/login_checks.h"
#include "kiosk/operator/network_test.h"

namespace cyclorama::operations {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ProcessObservation process(const std::string& name, bool is_healthy, const std::string& sentence) {
  ProcessObservation process;
  process.endpoint.name = name;
  process.asked = true;
  process.away = false;
  process.sentence = sentence;
  process.status.emplace();
  process.status->set_healthy(is_healthy);
  return process;
}

void set_gauge(ProcessObservation* process, const std::string& name, double value) {
  wire::Gauge* const gauge = process->status->add_gauges();
  gauge->set_name(name);
  gauge->set_value(value);
}

/// Returns findings without any problem; tests change one part.
Findings well() {
  Findings findings;
  findings.processes = {process("tour", true, "Visiting."), process("display", true, "Shows the tour."),
                        process("tracker", true, "Follows.")};
  set_gauge(&findings.processes[0], "synchronised_percent", 99.9);
  wire::Stage* const stage = findings.processes[0].status->add_stages();
  stage->set_name("farm_round_trip");
  stage->set_count(10);
  stage->set_p50_ms(60);
  stage->set_p95_ms(90);
  for (const char* const head : {"lit: left", "lit: right"}) set_gauge(&findings.processes[1], head, 1.0);
  set_gauge(&findings.processes[1], "awake", 1.0);
  set_gauge(&findings.processes[2], "frames_per_second", 30.0);
  findings.machine = {50'000'000'000, 100'000'000'000, false, 55.0, 100.0, true, 0.5, {}, 0, SecureBoot::kOn, true, {}};
  findings.is_museum = true;
  findings.provisioning.emplace();
  findings.provisioning->verdict = provision::ProvisioningVerdict::kInstalled;
  findings.provisioning->in_use = "000001";
  findings.provisioning->certificate_until = "2028-01-01";
  findings.update = update::UpdateStatus{update::UpdateStatus::State::kCurrent, "0.1.0", "", "", ""};
  std::tm day{};
  ::strptime("2026-11-22", "%Y-%m-%d", &day);
  findings.now = std::chrono::system_clock::from_time_t(::timegm(&day));
  return findings;
}

Check find(const Findings& findings, std::string_view id) {
  for (const Check& check : checks_of(findings)) {
    if (check.id == id) return check;
  }
  return {"", "not in the list", CheckLevel::kOk, "", ""};
}

TEST(Checks, report_nothing_when_all_is_well) {
  for (const Check& check : checks_of(well())) {
    EXPECT_EQ(check.level, CheckLevel::kOk) << check.id << ": " << check.sentence;
    EXPECT_THAT(check.remedy, IsEmpty()) << check.id;
    EXPECT_THAT(check.sentence, Not(IsEmpty())) << check.id;
  }
  EXPECT_GE(checks_of(well()).size(), 12u);
}

/// One problem: the id and level that its check must have, and how to cause it.
struct Trouble {
  const char* id;
  CheckLevel level;
  void (*make)(Findings*);
};
class CheckProblems : public testing::TestWithParam<Trouble> {};

TEST_P(CheckProblems, are_reported_alone_and_with_a_remedy) {
  Findings findings = well();
  GetParam().make(&findings);
  const Check check = find(findings, GetParam().id);
  EXPECT_EQ(check.level, GetParam().level) << check.sentence;
  EXPECT_THAT(check.remedy, Not(IsEmpty()));
  const auto checks = checks_of(findings);
  EXPECT_EQ(worst_of(checks), GetParam().level);
  EXPECT_EQ(std::count_if(checks.begin(), checks.end(), [](const Check& c) { return c.level != CheckLevel::kOk; }), 1);
  const std::string table = checks_table(checks);
  EXPECT_EQ(table.find(to_text(GetParam().level)), 0u) << "the worst first";
  EXPECT_THAT(table, HasSubstr("-> " + check.remedy));
}

INSTANTIATE_TEST_SUITE_P(
    Each, CheckProblems,
    testing::Values(
        Trouble{"part-tour", CheckLevel::kFault, [](Findings* f) { f->processes[0].status->set_healthy(false); }},
        Trouble{"part-tracker", CheckLevel::kWarning, [](Findings* f) { f->processes[2].status->set_healthy(false); }},
        Trouble{"part-nobody", CheckLevel::kFault,
                [](Findings* f) {
                  f->processes.push_back(process("nobody", false, "It cannot be reached."));
                  f->processes.back().away = true;
                }},
        Trouble{"heads", CheckLevel::kFault,
                [](Findings* f) { f->processes[1].status->mutable_gauges(0)->set_value(0.0); }},
        Trouble{"synchronised", CheckLevel::kWarning,
                [](Findings* f) { f->processes[0].status->mutable_gauges(0)->set_value(98.0); }},
        Trouble{"synchronised", CheckLevel::kFault,
                [](Findings* f) { f->processes[0].status->mutable_gauges(0)->set_value(50.0); }},
        Trouble{"camera", CheckLevel::kWarning,
                [](Findings* f) { f->processes[2].status->mutable_gauges(0)->set_value(1.0); }},
        Trouble{"farm", CheckLevel::kWarning,
                [](Findings* f) { f->processes[0].status->mutable_stages(0)->set_p95_ms(900); }},
        Trouble{"settings", CheckLevel::kWarning,
                [](Findings* f) { f->provisioning->verdict = provision::ProvisioningVerdict::kRefused; }},
        Trouble{"settings", CheckLevel::kFault,
                [](Findings* f) {
                  f->provisioning->verdict = provision::ProvisioningVerdict::kRefused;
                  f->provisioning->in_use = "";
                }},
        Trouble{"settings", CheckLevel::kWarning, [](Findings* f) { f->provisioning.reset(); }},
        Trouble{"certificate", CheckLevel::kWarning,
                [](Findings* f) { f->provisioning->certificate_until = "2026-12-01"; }},
        Trouble{"certificate", CheckLevel::kFault,
                [](Findings* f) { f->provisioning->certificate_until = "2026-11-01"; }},
        Trouble{"clock", CheckLevel::kWarning, [](Findings* f) { f->machine.is_clock_set = false; }},
        Trouble{"clock", CheckLevel::kFault, [](Findings* f) { f->now = std::chrono::system_clock::from_time_t(0); }},
        Trouble{"disk", CheckLevel::kWarning, [](Findings* f) { f->machine.disk_free_bytes = 5'000'000'000; }},
        Trouble{"disk", CheckLevel::kFault, [](Findings* f) { f->machine.disk_free_bytes = 1'000; }},
        Trouble{"disk", CheckLevel::kFault, [](Findings* f) { f->machine.is_read_only = true; }},
        Trouble{"memory", CheckLevel::kWarning, [](Findings* f) { f->machine.memory_free_share = 0.01; }},
        Trouble{"disk", CheckLevel::kFault, [](Findings* f) { f->machine.only_in_memory = "the TPM is gone"; }},
        Trouble{"settings", CheckLevel::kWarning,
                [](Findings* f) { f->provisioning->verdict = provision::ProvisioningVerdict::kUnconfirmed; }},
        Trouble{"secure-boot", CheckLevel::kFault, [](Findings* f) { f->machine.secure_boot = SecureBoot::kOff; }},
        Trouble{"secure-boot", CheckLevel::kFault,
                [](Findings* f) { f->machine.secure_boot = SecureBoot::kSetupMode; }},
        Trouble{"encryption", CheckLevel::kFault,
                [](Findings* f) {
                  f->machine.is_encrypted = false;
                  f->machine.unencrypted = "Secure Boot is off";
                }},
        Trouble{"temperature", CheckLevel::kWarning, [](Findings* f) { f->machine.warmest_c = 91.0; }},
        Trouble{"temperature", CheckLevel::kFault, [](Findings* f) { f->machine.warmest_c = 99.0; }},
        Trouble{"update", CheckLevel::kWarning,
                [](Findings* f) { f->update->state = update::UpdateStatus::State::kFailed; }},
        Trouble{"update", CheckLevel::kWarning,
                [](Findings* f) { f->update->state = update::UpdateStatus::State::kRolledBack; }}));

TEST(Checks, accept_dark_projectors_while_the_museum_is_closed) {
  Findings findings = well();
  for (int i = 0; i < 3; ++i) findings.processes[1].status->mutable_gauges(i)->set_value(0.0);
  EXPECT_EQ(find(findings, "heads").level, CheckLevel::kOk);
}

TEST(Checks, report_nothing_about_unknown_facts) {
  Findings findings = well();
  findings.machine = {};
  findings.update.reset();
  for (const char* const id : {"disk", "memory", "temperature", "clock", "update", "secure-boot", "encryption"}) {
    EXPECT_EQ(find(findings, id).title, "not in the list") << id;
  }
}

TEST(MachineFacts, are_read_from_the_kernels_files) {
  std::string name = (std::filesystem::temp_directory_path() / "machine-XXXXXX").string();
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path root = name;
  const auto write = [&](const std::string& path, const std::string& text) {
    std::filesystem::create_directories((root / path).parent_path());
    EXPECT_TRUE(write_file_atomically(root / path, std::string_view(text)));
  };
  for (const auto& [zone, degrees] : {std::pair("0", "41000\n"), {"1", "63500\n"}, {"2", "-273000\n"}, {"3", "junk"}}) {
    write(std::string("sys/class/thermal/thermal_zone") + zone + "/temp", degrees);
  }
  write("sys/class/thermal/thermal_zone1/trip_point_0_type", "passive\n");
  write("sys/class/thermal/thermal_zone1/trip_point_1_type", "critical\n");
  write("sys/class/thermal/thermal_zone1/trip_point_1_temp", "105000\n");
  write("proc/meminfo", "MemTotal:  1000 kB\nMemFree: 10 kB\nMemAvailable:  250 kB\n");
  write("run/systemd/timesync/synchronized", "");
  write("run/cyclorama/var", "in memory: the disk cannot be read\n");
  write("sys/devices/system/cpu/cpu0/thermal_throttle/package_throttle_count", "12\n");
  const MachineFacts facts = read_machine_facts(root, root);
  EXPECT_EQ(facts.warmest_c, 63.5);
  EXPECT_EQ(facts.critical_c, 105.0);
  EXPECT_EQ(facts.memory_free_share, 0.25);
  EXPECT_EQ(facts.is_clock_set, true);
  EXPECT_EQ(facts.only_in_memory, "the disk cannot be read");
  EXPECT_EQ(facts.slowed_by_heat, 12u);
  write("run/cyclorama/var", "encrypted\n");
  EXPECT_EQ(read_machine_facts(root, root).only_in_memory, "");
  EXPECT_TRUE(read_machine_facts(root, root).is_encrypted);
  write("run/cyclorama/var", "plain: Secure Boot is off\n");
  EXPECT_EQ(read_machine_facts(root, root).unencrypted, "Secure Boot is off");
  EXPECT_FALSE(read_machine_facts(root, root).is_encrypted);
  for (const auto& [word, meaning] : {std::pair("on", SecureBoot::kOn), std::pair("setup", SecureBoot::kSetupMode),
                                      std::pair("off", SecureBoot::kOff), std::pair("?", SecureBoot::kUnknown)}) {
    write("run/cyclorama/secure-boot", std::string(word) + "\n");
    EXPECT_EQ(read_machine_facts(root, root).secure_boot, meaning) << word;
  }
  EXPECT_GT(*facts.disk_bytes, *facts.disk_free_bytes);
  std::filesystem::remove_all(root);
  EXPECT_FALSE(read_machine_facts(root, root).warmest_c) << "nothing is known of nothing";
}

TEST(Checks, report_the_state_of_each_projector) {
  Findings findings = well();
  findings.processes.push_back(process("projectors", false, "1 of 2 projectors are as they should be."));
  wire::Table* const table = findings.processes.back().status->add_tables();
  table->set_name("projectors");
  for (const char* const column : {"name", "level", "sentence", "remedy"}) table->add_columns(column);
  const auto add_row = [&](const std::vector<const char*>& cells) {
    wire::Row* const row = table->add_rows();
    for (const char* const cell : cells) row->add_cells()->set_text(cell);
  };
  add_row({"left", "ok", "Its lamp is on.", ""});
  add_row({"right", "fault", "Its lamp is off, though the museum is open.", "Switch it on by its remote control."});
  add_row({"too short"});
  const std::vector<Check> checks = checks_of(findings);
  const auto find = [&](const std::string& id) {
    return std::find_if(checks.begin(), checks.end(), [&](const Check& check) { return check.id == id; });
  };
  ASSERT_NE(find("projector-right"), checks.end());
  EXPECT_EQ(find("projector-right")->level, CheckLevel::kFault);
  EXPECT_THAT(find("projector-right")->remedy, HasSubstr("remote control"));
  EXPECT_EQ(find("projector-left")->level, CheckLevel::kOk);
  EXPECT_EQ(find("part-projectors"), checks.end()) << "what is wrong is said once";
  table->clear_rows();
  findings.processes.back() = process("projectors", true, "No projector has a network address in the settings.");
  EXPECT_THAT(checks_table(checks_of(findings)), HasSubstr("No projector has a network address"));
}

TEST(LoginChecks, report_only_why_nobody_can_log_in) {
  Findings findings = well();
  findings.is_museum = false;
  findings.provisioning.reset();
  std::vector<Check> told = login_checks(findings);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0].sentence, HasSubstr("No stick with settings was ever plugged in"));
  EXPECT_THAT(told[0].remedy, HasSubstr("site.toml"));

  findings.provisioning.emplace();
  findings.provisioning->at = "2026-11-22T09:00:00Z";
  findings.provisioning->problems = {"site.toml:3: farm.coordinator: is not a setting; did you mean 'coordinators'?"};
  findings.machine.only_in_memory = "the disk cannot be read";
  told = login_checks(findings);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_THAT(told[0].sentence, HasSubstr("no settings in use. site.toml:3: farm.coordinator"));
  EXPECT_FALSE(told[0].sentence.ends_with('\n'));
  EXPECT_THAT(told[1].sentence, HasSubstr("forgets its settings when it is switched off: the disk cannot be read"));
  EXPECT_FALSE(told[1].remedy.empty());

  findings = well();
  findings.provisioning->museum = "hall-3";
  told = login_checks(findings);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[1].id, "pin");
  EXPECT_THAT(told[1].remedy, HasSubstr("operator.toml"));
  for (const Check& check : told) EXPECT_THAT(check.sentence, Not(HasSubstr("hall-3")));
}

TEST(MachineFacts, do_not_take_a_read_only_mount_for_a_broken_disk) {
  std::string name = (std::filesystem::temp_directory_path() / "machine-XXXXXX").string();
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path root = name;
  std::filesystem::create_directories(root / "proc/self");
  struct stat info {};
  ASSERT_EQ(::stat(root.c_str(), &info), 0);
  const auto is_read_only = [&](const std::string& of_mount, const std::string& of_file_system) {
    const std::string line = "{} {}:{} / {} {} - ext4 /dev/{} {}\n";
    std::string text = fmt::format(fmt::runtime(line), "21 1", 0, 9999, "/proc", "rw", "x", "ro");
    text += fmt::format(fmt::runtime(line), "36 21", major(info.st_dev), minor(info.st_dev), "/var", of_mount,
                        "mapper/var", of_file_system);
    EXPECT_TRUE(write_file_atomically(root / "proc/self/mountinfo", std::string_view(text)));
    return read_machine_facts(root, root).is_read_only;
  };
  EXPECT_EQ(is_read_only("rw,noatime shared:3", "rw,errors=remount-ro"), false);
  EXPECT_EQ(is_read_only("ro,noatime", "rw"), false) << "ProtectSystem= made that mount for this service";
  EXPECT_EQ(is_read_only("rw,noatime shared:3", "ro"), true);
  EXPECT_EQ(is_read_only("ro", "ro,errors=remount-ro"), true);
  std::filesystem::remove(root / "proc/self/mountinfo");
  EXPECT_EQ(read_machine_facts(root, root).is_read_only, false) << "nothing says that it is";
  std::filesystem::remove_all(root);
}

TEST(UpdateStatus, is_read_from_the_updaters_file) {
  const auto status = update::parse_update_status(
      R"({"state": "ready", "version": "0.1.0", "available": "0.2.0", "at": "2026-11-22T03:10:00Z", "later": 1})");
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, update::UpdateStatus::State::kReady);
  EXPECT_EQ(status->available, "0.2.0");
  for (const char* const bad : {"", "[]", "{}", R"({"state": "odd", "version": "1"})", R"({"state": "ready"})",
                                R"({"state": 1, "version": "1"})"}) {
    EXPECT_FALSE(update::parse_update_status(bad)) << bad;
  }
}

TEST(NetworkTest, names_the_step_at_which_the_connection_fails) {
  using std::chrono::milliseconds;
  const auto checks =
      test_network({"[::1]:1", "farm", "no-such-host.invalid:7401", "unix:/run/x"}, {}, milliseconds(500));
  ASSERT_EQ(checks.size(), 4u);
  EXPECT_THAT(checks[1].remedy, HasSubstr("its program does not run"));
  EXPECT_THAT(checks[2].remedy, HasSubstr("site.toml"));
  EXPECT_THAT(checks[3].sentence, HasSubstr("name cannot be found"));
  EXPECT_THAT(test_network({}, {}).back().sentence, HasSubstr("No farm is named"));
}

}  // namespace
}  // namespace cyclorama::operations
