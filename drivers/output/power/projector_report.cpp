// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/power/projector_report.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "common/language/marked_texts.h"

namespace cyclorama::output {
namespace {

using Level = ProjectorReport::Level;

constexpr auto kToSwitch = std::chrono::seconds(90);  // Some projectors report the old state for a minute.
// Upper bound for warming up or cooling down; manuals give 1 to 3 minutes.
constexpr auto kMaxTransition = std::chrono::minutes(6);

struct Part {
  std::string_view name;
  std::string_view remedy;
};
/// Ordered as in the answer to ERST.
constexpr std::array<Part, 6> kParts{{
    {translatable("fan"), "Clean its vents and let air reach it; if that does not help, have it repaired."},
    {translatable("lamp"), "Its lamp is at its end: have it replaced."},
    {translatable("temperature"), "It is too warm: clean its vents and its filter, and let air reach it."},
    {translatable("cover"), "Close its covers."},
    {translatable("filter"), "Clean its filter, or replace it."},
    {translatable("other"), "Look at its own display, and into its manual."},
}};

std::optional<ProjectorReport> of_errors(const ProjectorErrors& errors) {
  ProjectorReport report;
  for (std::size_t i = 0; i < kParts.size(); ++i) {
    const ProjectorErrors::Kind kind = errors.of[i];
    if (kind == ProjectorErrors::Kind::kNone) continue;
    const bool is_error = kind == ProjectorErrors::Kind::kError;
    report.level = std::max(report.level, is_error ? Level::kFault : Level::kWarning);
    report.sentence += report.sentence.empty() ? "It reports: " : ", ";
    report.sentence +=
        fmt::format(fmt::runtime(is_error ? translatable("{} (error)") : translatable("{} (warning)")), kParts[i].name);
    report.remedy += (report.remedy.empty() ? "" : " ") + std::string(kParts[i].remedy);
  }
  if (report.sentence.empty()) return std::nullopt;
  report.sentence += ".";
  return report;
}

ProjectorReport of_silence(const Error& error) {
  switch (error.code()) {
    case ErrorCode::kInvalidArgument:
      return {Level::kWarning, "It refuses our password, so it is not switched: " + error.message() + ".",
              "Write the password that is set in the projector's menu into the file that pjlink_password_file names."};
    case ErrorCode::kBadData:
      return {Level::kWarning, "What answers is no projector: " + error.message() + ".",
              "See that its address in installation.toml is right, and that PJLink is switched on in its menu."};
    case ErrorCode::kSystem:
      return {Level::kFault, "It reports a failure.", "Look at its own display, and into its manual."};
    default:
      return {Level::kWarning, "It does not answer, so it is not switched: " + error.message() + ".",
              "See that it has power and its network cable is in, and that its menu lets it answer while it is off "
              "(network standby)."};
  }
}

}  // namespace

std::string_view to_text(Level level) {
  return level == Level::kFault ? "fault" : level == Level::kWarning ? "warning" : "ok";
}

ProjectorReport ProjectorReporter::see(const ProjectorStatus& look, TimePoint now) {
  const Condition condition{look.should_be_on, look.power ? std::optional(*look.power) : std::nullopt};
  if (condition_ != condition) since_ = now;
  condition_ = condition;
  if (!look.power) return of_silence(look.power.error());
  if (look.errors) {
    if (auto report = of_errors(*look.errors)) return *std::move(report);
  }
  const Duration lasted = now - since_;
  const bool is_new = lasted < kToSwitch;
  switch (*look.power) {
    case ProjectorPower::kOn:
      if (look.should_be_on) return {Level::kOk, "Its lamp is on.", ""};
      if (is_new) return {Level::kOk, "It is being switched off.", ""};
      return {
          Level::kWarning, "Its lamp is on, though the museum is closed.",
          "Who switched it on by hand has a reason, so it is left alone until the museum has opened and closed again; "
          "switch it off by its remote control."};
    case ProjectorPower::kOff:
      if (!look.should_be_on) return {Level::kOk, "Its lamp is off: the museum is closed.", ""};
      if (is_new) return {Level::kOk, "It is being switched on.", ""};
      return {Level::kFault, "Its lamp is off, though the museum is open.",
              "Switch it on by its remote control. Who switches one off by hand has a reason, so it is left alone "
              "until the "
              "museum opens again."};
    case ProjectorPower::kWarming:
      if (lasted < kMaxTransition) return {Level::kOk, "It warms up.", ""};
      return {Level::kWarning, "It has been warming up for minutes.", "Take its power away for a minute."};
    case ProjectorPower::kCooling:
      break;
  }
  if (lasted < kMaxTransition) return {Level::kOk, "It cools down.", ""};
  return {Level::kWarning, "It has been cooling down for minutes.", "Take its power away for a minute."};
}

}  // namespace cyclorama::output
