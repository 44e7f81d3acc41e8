// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <nlohmann/json.hpp>

#include "common/base/text.h"
#include "common/language/marked_texts.h"

namespace cyclorama::operations {
namespace {

constexpr double kMinSynchronised_percent = 99.0;
constexpr double kMinSynchronisedWarning_percent = 90.0;
constexpr double kSlowFarm_ms = 500.0;
constexpr double kMinCamera_hz = 5.0;
constexpr double kMinFreeShare = 0.10;
constexpr double kWorstFree = 0.03;
constexpr double kWarm_c = 85.0;  // Used if no zone reports its critical temperature.
constexpr double kHot_c = 95.0;
constexpr double kBelowCritical_c = 10.0;
constexpr double kMinFreeMemoryShare = 0.05;
constexpr int kCertificateWarning_days = 21;  ///< A farm that renews has had nine days for it.
constexpr std::string_view kLit = "lit: ";

struct Part {
  std::string_view name;
  std::string_view title;
  CheckLevel unwell;  ///< Level of the check while the part is unhealthy.
  std::string_view remedy;
};
constexpr std::array<Part, 8> kParts{{
    {"tour", "Tour", CheckLevel::kFault, "Run the network test: it tells whether the farm or the network is away."},
    {"display", "Display", CheckLevel::kFault,
     "See that the projectors have power and their cables are in; else start this computer again."},
    {"tracker", "Tracker", CheckLevel::kWarning, "See that the camera is plugged in, sees the visitor, and has light."},
    {"calibrator", "Calibrator", CheckLevel::kWarning,
     "A calibration can be begun again; the wall shows the last one's."},
    {"coordinator", "Farm", CheckLevel::kFault, "Tell those who run the farm."},
    {"hand", "Hand controls", CheckLevel::kWarning, "Plug the controller in again."},
    {"projectors", "Projectors' power", CheckLevel::kWarning, "See the entry of each projector."},
    {"simulated-room", "Simulated room", CheckLevel::kWarning, "A real wall does not need it."},
}};

const Part* part_of(std::string_view name) {
  const auto known = std::find_if(kParts.begin(), kParts.end(), [&](const Part& part) { return part.name == name; });
  return known == kParts.end() ? nullptr : &*known;
}

const ProcessObservation* find(const Findings& findings, std::string_view name) {
  for (const ProcessObservation& process : findings.processes) {
    if (process.endpoint.name == name && !process.away && process.status) return &process;
  }
  return nullptr;
}

class List {
 public:
  explicit List(const Findings& findings) : findings_(findings) {}

  std::vector<Check> all() {
    for (const ProcessObservation& process : findings_.processes) part(process);
    heads();
    graphics();
    synchronised_share();
    camera();
    cameras_without_driver();
    unread_sticks();
    farm();
    provisioning();
    certificate();
    clock();
    disk();
    secure_boot();
    encryption();
    memory();
    temperature();
    update();
    return std::move(checks_);
  }

 private:
  void add(std::string id, std::string title, CheckLevel level, std::string sentence, std::string remedy) {
    if (level == CheckLevel::kOk) remedy.clear();
    checks_.push_back({std::move(id), std::move(title), level, std::move(sentence), std::move(remedy)});
  }

  void part(const ProcessObservation& process) {
    const std::string& name = process.endpoint.name;
    const Part* const known = part_of(name);
    const std::string title = known == nullptr ? name : std::string(known->title);
    const std::string id = "part-" + name;
    if (!process.asked) return add(id, title, CheckLevel::kOk, "It has not been queried yet.", "");
    if (process.away) {
      return add(id, title, CheckLevel::kFault, process.sentence,
                 "Wait a minute: it starts again by itself. If it stays away, start this computer again; if that does "
                 "not help, download the support bundle and send it to us.");
    }
    if (name == "projectors" && projectors(process)) return;
    if (process.is_well()) return add(id, title, CheckLevel::kOk, process.sentence, "");
    add(id, title, known == nullptr ? CheckLevel::kWarning : known->unwell, process.sentence,
        known == nullptr ? "Start this computer again." : std::string(known->remedy));
  }

  /// Adds a check for each projector that cyclorama-projectors reports; returns false if it reports none.
  bool projectors(const ProcessObservation& process) {
    if (!process.status) return false;
    bool any = false;
    for (const wire::Table& table : process.status->tables()) {
      if (table.name() != "projectors" || table.columns_size() != 4) continue;
      for (const wire::Row& row : table.rows()) {
        if (row.cells_size() != 4) continue;
        const auto text = [&](int cell) { return printable(row.cells(cell).text(), 500); };
        const std::string level = text(1);
        any = true;
        add("projector-" + text(0), fmt::format("Projector '{}'", text(0)),
            level == "fault" ? CheckLevel::kFault
            : level == "ok"  ? CheckLevel::kOk
                             : CheckLevel::kWarning,
            text(2), text(3));
      }
    }
    return any;
  }

  void heads() {
    const ProcessObservation* const display = find(findings_, "display");
    if (display == nullptr) return;
    int count = 0;
    std::string dark;
    for (const wire::Gauge& gauge : display->status->gauges()) {
      if (!gauge.name().starts_with(kLit)) continue;
      ++count;
      if (gauge.value() == 0.0)
        dark += (dark.empty() ? "'" : ", '") + printable(gauge.name().substr(kLit.size())) + "'";
    }
    if (count == 0) return;
    const bool sleeps = gauge_of(*display->status, "awake").value_or(1.0) == 0.0;
    if (sleeps) return add("heads", "Projectors", CheckLevel::kOk, "They are off: the museum is closed.", "");
    if (dark.empty())
      return add("heads", "Projectors", CheckLevel::kOk, fmt::format("All {} get a picture from this computer.", count),
                 "");
    add("heads", "Projectors", CheckLevel::kFault, fmt::format("No picture goes to {}.", dark),
        "Switch that projector on, and see that its cable is in at both ends.");
  }

  /// Adds a check for cards without a driver, and for a picture that the processor draws instead of the card.
  void graphics() {
    constexpr const char* kUse =
        "Use a card or a processor's graphics that the guide of the appliance lists, or a socket of one that has a "
        "driver.";
    std::string driven;
    std::string undriven;
    for (const GraphicsCard& card : findings_.hardware.cards) {
      if (card.maker.empty()) continue;  // A virtual machine's card never draws by itself.
      std::string& list = card.driver.empty() ? undriven : driven;
      list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", card.maker, card.id);
      if (!card.driver.empty()) list += " by " + card.driver;
    }
    if (!undriven.empty()) {
      add("graphics-driver", "Graphics card", driven.empty() ? CheckLevel::kFault : CheckLevel::kWarning,
          fmt::format("No driver took {}: this software does not support the card, or is older than it.", undriven),
          kUse);
    }
    const ProcessObservation* const display = find(findings_, "display");
    if (display == nullptr || driven.empty()) return;
    const std::string renderer = fact_of(*display->status, "gl_renderer");
    if (renderer.empty()) return;
    const bool is_software = renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe");
    add("graphics", "Graphics", is_software ? CheckLevel::kWarning : CheckLevel::kOk,
        is_software ? fmt::format("The processor draws the picture, since {} cannot.", driven)
                    : fmt::format("The picture is drawn by {}.", driven),
        kUse);
  }

  void cameras_without_driver() {
    for (const UndrivenCamera& camera : findings_.hardware.cameras) {
      add("camera-driver", "Camera without a driver", CheckLevel::kWarning,
          camera.is_industrial ? fmt::format("'{}' speaks USB3 Vision, which this software does not.", camera.name)
                               : fmt::format("'{}' is plugged in, and no driver takes it.", camera.name),
          "Use a camera that says UVC, or 'works without drivers'.");
    }
  }

  void unread_sticks() {
    for (const UnreadStick& stick : findings_.hardware.sticks) {
      add("stick", "USB stick", CheckLevel::kWarning,
          stick.file_system.empty()
              ? fmt::format("The stick {} has no file system that is known here.", stick.block)
              : fmt::format("The stick {} is formatted as {}, which is not read.", stick.block, stick.file_system),
          "Format it as FAT32 (\"FAT\" or \"MS-DOS\" on some computers), and copy the folder 'cyclorama' to it again.");
    }
  }

  void synchronised_share() {
    for (const char* const name : {"tour", "display"}) {
      const ProcessObservation* const process = find(findings_, name);
      const auto share = process == nullptr ? std::nullopt : gauge_of(*process->status, "synchronised_percent");
      if (!share) continue;
      const CheckLevel level = *share < kMinSynchronisedWarning_percent ? CheckLevel::kFault
                               : *share < kMinSynchronised_percent      ? CheckLevel::kWarning
                                                                        : CheckLevel::kOk;
      return add("synchronised", "Synchronised displays", level,
                 fmt::format("They show the same frame in {:.2f} of 100 refreshes.", *share),
                 "See that the displays' computers are on one cable network, not on wireless, and that each asks the "
                 "tour's computer for the time.");
    }
  }

  void camera() {
    const ProcessObservation* const tracker = find(findings_, "tracker");
    const auto rate = tracker == nullptr ? std::nullopt : gauge_of(*tracker->status, "frames_per_second");
    if (!rate) return;
    const CheckLevel level = *rate < kMinCamera_hz ? CheckLevel::kWarning : CheckLevel::kOk;
    add("camera", "Camera", level, fmt::format("It sends {:.1f} pictures a second.", *rate),
        "Plug it in again, in the socket that was chosen for it; look at its picture on this page.");
  }

  void farm() {
    const ProcessObservation* const tour = find(findings_, "tour");
    if (tour == nullptr) return;
    for (const wire::Stage& stage : tour->status->stages()) {
      if (stage.name() != "farm_round_trip" || stage.count() == 0) continue;
      const CheckLevel level = stage.p95_ms() > kSlowFarm_ms ? CheckLevel::kWarning : CheckLevel::kOk;
      add("farm", "Round trip to the farm", level,
          fmt::format("A picture takes {:.0f} ms, and 95 of 100 take less than {:.0f} ms.", stage.p50_ms(),
                      stage.p95_ms()),
          "Run the network test. If the network is quick, the farm has too much to do: tell those who run it.");
    }
  }

  void provisioning() {
    if (!findings_.is_museum) return;
    const auto& report = findings_.provisioning;
    constexpr const char* kRemedy =
        "Correct what is named on the stick, in its folder 'cyclorama', and plug it in again.";
    if (!report) {
      return add("settings", "Settings", CheckLevel::kWarning, "No stick with settings was ever plugged in.",
                 "Plug in a stick with a folder 'cyclorama' that has site.toml and installation.toml.");
    }
    if (report->verdict == provision::ProvisioningVerdict::kUnconfirmed) {
      return add(
          "settings", "Settings", CheckLevel::kWarning,
          fmt::format("The stick of {} was not taken: {}.", report->at,
                      report->problems.empty() ? "nobody has answered for it" : printable(report->problems[0], 500)),
          "If the stick is the museum's, press 'Take this stick' on the operator page.");
    }
    if (report->verdict != provision::ProvisioningVerdict::kRefused) {
      return add("settings", "Settings", CheckLevel::kOk, fmt::format("Those of {} are in use.", report->at), "");
    }
    std::string why;
    for (const std::string& problem : report->problems) why += " " + problem + ".";
    add("settings", "Settings", report->in_use.empty() ? CheckLevel::kFault : CheckLevel::kWarning,
        fmt::format(fmt::runtime(report->in_use.empty()
                                     ? "The stick of {} was refused, and there are no settings in use."
                                     : "The stick of {} was refused, and the settings before it stay in use."),
                    report->at) +
            printable(why, 2000),
        kRemedy);
  }

  void certificate() {
    if (!findings_.provisioning || findings_.provisioning->certificate_until.empty()) return;
    const std::string& until = findings_.provisioning->certificate_until;
    std::tm day{};
    if (::strptime(until.c_str(), "%Y-%m-%d", &day) == nullptr) return;
    const double left_s = std::difftime(::timegm(&day), std::chrono::system_clock::to_time_t(findings_.now));
    const int left = static_cast<int>(left_s / 86400.0);
    const CheckLevel level = left_s < 0.0                      ? CheckLevel::kFault
                             : left < kCertificateWarning_days ? CheckLevel::kWarning
                                                               : CheckLevel::kOk;
    add("certificate", "Certificate for the farm", level,
        left_s < 0.0
            ? fmt::format("It expired on {}.", until)
            : fmt::format(fmt::runtime(plural("It is good until {}, {} day.", "It is good until {}, {} days.", left)),
                          until, left),
        "It is renewed from the farm 30 days before its end, where the farm's operator has set that up. Else ask them "
        "for a new bundle, put it on a stick with the other settings, and plug it in.");
  }

  void clock() {
    std::tm parts{};
    const std::time_t now = std::chrono::system_clock::to_time_t(findings_.now);
    if (::gmtime_r(&now, &parts) != nullptr && parts.tm_year + 1900 < 2026) {
      return add("clock", "Clock", CheckLevel::kFault, fmt::format("It shows the year {}.", parts.tm_year + 1900),
                 "Connect the network, so that it is set; if it is wrong after each night, the battery on the board is "
                 "empty.");
    }
    if (!findings_.machine.is_clock_set) return;
    const bool is_set = *findings_.machine.is_clock_set;
    add("clock", "Clock", is_set ? CheckLevel::kOk : CheckLevel::kWarning,
        is_set ? "A time server sets it." : "No time server has set it since the start; it goes on by itself.",
        "See that the network is connected and lets time (NTP) through. The opening hours go by this clock.");
  }

  void disk() {
    const MachineFacts& machine = findings_.machine;
    if (!machine.only_in_memory.empty()) {
      return add("disk", "Disk", CheckLevel::kFault,
                 fmt::format("This computer forgets its settings when it is switched off: {}.", machine.only_in_memory),
                 "Hold the space bar while it starts, choose 'forget all settings', and plug in the stick with the "
                 "settings. If it says so again, the disk is worn out and must be replaced.");
    }
    if (machine.is_read_only.value_or(false)) {
      return add("disk", "Disk", CheckLevel::kFault, "It cannot be written any more.",
                 "Start this computer again. If that happens again, the disk is worn out and must be replaced.");
    }
    if (!machine.disk_free_bytes || !machine.disk_bytes || *machine.disk_bytes == 0) return;
    const double share = static_cast<double>(*machine.disk_free_bytes) / static_cast<double>(*machine.disk_bytes);
    const CheckLevel level = share < kWorstFree      ? CheckLevel::kFault
                             : share < kMinFreeShare ? CheckLevel::kWarning
                                                     : CheckLevel::kOk;
    add("disk", "Disk", level,
        fmt::format("{:.1f} GB of {:.1f} GB are free.", 1e-9 * static_cast<double>(*machine.disk_free_bytes),
                    1e-9 * static_cast<double>(*machine.disk_bytes)),
        "The show goes on, but new settings, calibrations and updates may be refused. Download the support bundle and "
        "send it to us.");
  }

  void secure_boot() {
    constexpr const char* kId = "secure-boot";
    constexpr const char* kTitle = "Secure Boot";
    switch (findings_.machine.secure_boot) {
      case SecureBoot::kUnknown:
        return;
      case SecureBoot::kOn:
        return add(kId, kTitle, CheckLevel::kOk, "It is on: this computer starts only what bears our signature.", "");
      case SecureBoot::kSetupMode:
        return add(kId, kTitle, CheckLevel::kFault, "It has no keys yet, so this computer starts anything.",
                   "Start this computer again, and press no key: it counts 15 seconds down and takes its keys. If it "
                   "says so again, its firmware does not keep them: update the firmware.");
      case SecureBoot::kOff:
        return add(kId, kTitle, CheckLevel::kFault, "It is off, so this computer starts anything.",
                   "In the firmware's settings, delete the keys of Secure Boot (setup mode), switch it on, and start "
                   "this computer again: it takes its keys by itself.");
    }
  }

  void encryption() {
    const MachineFacts& machine = findings_.machine;
    if (machine.is_encrypted) {
      return add("encryption", "Encryption", CheckLevel::kOk,
                 "Settings and keys on the disk open only in this computer, and only for our software.", "");
    }
    if (machine.unencrypted.empty()) return;
    add("encryption", "Encryption", CheckLevel::kFault,
        fmt::format("Settings and keys lie on the disk as they are: {}.", machine.unencrypted),
        "Switch on the TPM and Secure Boot in the firmware's settings, and start this computer again: it encrypts them "
        "without losing any.");
  }

  void memory() {
    if (!findings_.machine.memory_free_share) return;
    const double share = *findings_.machine.memory_free_share;
    add("memory", "Memory", share < kMinFreeMemoryShare ? CheckLevel::kWarning : CheckLevel::kOk,
        fmt::format("{:.0f} % is free.", 100.0 * share), "Start this computer again at a quiet moment.");
  }

  void temperature() {
    const auto& warmest = findings_.machine.warmest_c;
    if (!warmest) return;
    const double hot = findings_.machine.critical_c.value_or(kHot_c + 5.0) - 5.0;
    const double warm = findings_.machine.critical_c ? *findings_.machine.critical_c - kBelowCritical_c : kWarm_c;
    const CheckLevel level = *warmest >= hot    ? CheckLevel::kFault
                             : *warmest >= warm ? CheckLevel::kWarning
                                                : CheckLevel::kOk;
    std::string sentence = fmt::format("The warmest part has {:.0f} °C.", *warmest);
    if (findings_.machine.slowed_by_heat > 0) {
      const auto times = findings_.machine.slowed_by_heat;
      sentence += " " + fmt::format(fmt::runtime(plural("Heat has slowed the processor down {} time since the start.",
                                                        "Heat has slowed the processor down {} times since the start.",
                                                        static_cast<long long>(times))),
                                    times);
    }
    add("temperature", "Temperature", level, sentence,
        "Clean the computer's vents, and let air reach it; it slows down or switches itself off when it is too warm.");
  }

  void update() {
    const auto& update = findings_.update;
    if (!update) return;
    using State = update::UpdateStatus::State;
    const bool is_bad = update->state == State::kFailed || update->state == State::kRolledBack;
    std::string sentence = fmt::format("Version {} runs.", update->version);
    if (update->state == State::kReady)
      sentence += fmt::format(" Version {} begins with the next start.", update->available);
    if (update->state == State::kLoading) sentence += fmt::format(" Version {} is being fetched.", update->available);
    if (update->state == State::kRolledBack) {
      sentence += fmt::format(" Version {} did not start well, so this one was taken back.", update->available);
    }
    if (!update->sentence.empty()) sentence += " " + update->sentence;
    add("update", "Software", is_bad ? CheckLevel::kWarning : CheckLevel::kOk, sentence,
        update->state == State::kRolledBack
            ? "Nothing needs to be done here. Download the support bundle and send it to us, so that the next one is "
              "better."
            : "It is tried again by itself. Run the network test, or plug in a stick with the update.");
  }

  const Findings& findings_;
  std::vector<Check> checks_;
};

}  // namespace

std::string_view to_text(CheckLevel level) {
  return level == CheckLevel::kFault ? "fault" : level == CheckLevel::kWarning ? "warning" : "ok";
}

std::vector<Check> checks_of(const Findings& findings) { return List(findings).all(); }

CheckLevel worst_of(const std::vector<Check>& checks) {
  CheckLevel worst = CheckLevel::kOk;
  for (const Check& check : checks) worst = std::max(worst, check.level);
  return worst;
}

std::string checks_table(const std::vector<Check>& checks) {
  std::vector<Check> sorted = checks;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Check& a, const Check& b) { return a.level > b.level; });
  std::size_t widest = 0;
  for (const Check& check : sorted) widest = std::max(widest, check.title.size());
  std::string table;
  for (const Check& check : sorted) {
    table += fmt::format("{:<8} {:<{}}  {}\n", to_text(check.level), check.title, widest, check.sentence);
    if (!check.remedy.empty()) table += fmt::format("{:<8} {:<{}}  -> {}\n", "", "", widest, check.remedy);
  }
  return table;
}

std::string checks_json(const std::vector<Check>& checks) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Check& check : checks) {
    json.push_back({{"id", check.id},
                    {"title", check.title},
                    {"level", to_text(check.level)},
                    {"sentence", check.sentence},
                    {"remedy", check.remedy}});
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace cyclorama::operations
