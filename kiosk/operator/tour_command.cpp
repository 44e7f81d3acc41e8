// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/tour_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <filesystem>

#include "common/base/file.h"
#include "common/base/named_number.h"
#include "common/base/text.h"
#include "kiosk/operator/tour_call.h"
#include "kiosk/tour/plan/svx_import.h"
#include "kiosk/tour/plan/tour_folder.h"
#include "kiosk/tour/plan/tour_plan_text.h"

namespace cyclorama::operations {
namespace {

constexpr std::size_t kMaxSvxBytes = std::size_t{64} << 20;

/// Returns the text in the language; otherwise in the tour's first language; otherwise any.
std::string text_in(const google::protobuf::Map<std::string, std::string>& texts, const std::string& language,
                    const wire::StopList& list) {
  for (const std::string& tag : {language, list.languages_size() > 0 ? list.languages(0) : std::string()}) {
    if (const auto text = texts.find(tag); text != texts.end()) return printable(text->second, 4000);
  }
  return texts.empty() ? std::string() : printable(texts.begin()->second, 4000);
}

}  // namespace

void TourCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand("tour", "The stops of the visit: list them, go to them, add and check them");
  command.add_option("--tour", tour, "Address of cyclorama-tour")->type_name("HOST:PORT")->capture_default_str();
  command.require_subcommand(1);
  CLI::App& shown = *command.add_subcommand("show", "List the stops, and where the visitor is");
  shown.add_option("--language", language, "Such as de; otherwise the tour's first");
  CLI::App& led = *command.add_subcommand("go", "Lead the visitor to a stop");
  led.add_option("STOP", target, "next, previous, or a stop's name")->required();
  CLI::App& added = *command.add_subcommand("stop-here", "Add a stop where the visitor stands and looks");
  added.add_option("--name", name, "1 to 40 letters of a to z, digits and '-'; otherwise stop-1 and so on");
  added.add_option("--title", title, "Its title, in the tour's first language");
  command.add_subcommand("undo", "Undo the last stop-here, or the last undo");
  command.add_subcommand("fetch", "Fetch the pictures for the farm's absence now, although somebody visits");
  CLI::App& dimmed = *command.add_subcommand("lamps", "Fade groups of lamps of the scene to a level");
  dimmed.add_option("GROUP=LEVEL", lamps, "0 to 4; 1: as the scene describes it; any number of groups")->required();
  CLI::App& written = *command.add_subcommand("captions", "Choose the languages that are written on the wall");
  written.add_option("LANGUAGE", captions, "One or two of the tour's languages; or next, or none")
      ->required()
      ->expected(1, static_cast<int>(tour::kMaxShownLanguages));
  CLI::App& checked = *command.add_subcommand("check", "Check a tour's folder without a visit");
  checked.add_option("FOLDER", folder, "With tour.toml")->required();
  CLI::App& imported =
      *command.add_subcommand("import", "Make a tour of a Voyager document, and list what is left out");
  imported.add_option("FILE", svx, "A *.svx.json")->required();
  imported.add_option("--out", folder, "The folder for the new tour.toml; none may be there yet")->required();
  imported.add_option("--number", svx_tour, "Which of its tours, counted from 1")->check(CLI::Range(1, 10000));
}

Status TourCommand::run(const CLI::App& app) const {
  const CLI::App& command = *app.get_subcommand("tour");
  if (command.got_subcommand("show")) return show();
  if (command.got_subcommand("go")) return go_to();
  if (command.got_subcommand("stop-here")) return add();
  if (command.got_subcommand("undo")) return undo();
  if (command.got_subcommand("fetch")) return fetch();
  if (command.got_subcommand("lamps")) return dim();
  if (command.got_subcommand("captions")) return write();
  if (command.got_subcommand("check")) return check();
  return import_tour();
}

Status TourCommand::show() const {
  TRY_ASSIGN(const wire::StopList list, (call_tour<wire::StopList>(tour, "listing the stops", wire::ListStopsRequest(),
                                                                   &wire::Tour::Stub::ListStops)));
  if (!list.tour_title().empty()) fmt::print("{}\n", printable(list.tour_title(), 200));
  for (int i = 0; i < list.stops_size(); ++i) {
    const wire::StopSummary& stop = list.stops(i);
    const bool is_here = list.has_at() && list.at() == static_cast<std::uint32_t>(i);
    fmt::print("{} {:<12} {}{}\n", is_here ? (list.is_led() ? ">" : "*") : " ", printable(stop.name()),
               text_in(stop.titles(), language, list), stop.is_kept() ? "  [kept]" : "");
    if (const std::string text = text_in(stop.texts(), language, list); !text.empty()) fmt::print("    {}\n", text);
  }
  if (list.stops_size() == 0) fmt::print("no stops\n");
  if (list.problem().empty()) return Done{};
  return Error(ErrorCode::kBadData,
               "the newest tour is refused, and the one before stays: " + printable(list.problem(), 1000));
}

Status TourCommand::go_to() const {
  wire::GoToStopRequest request;
  if (target == "next" || target == "previous") {
    request.set_step(target == "next" ? 1 : -1);
  } else {
    request.set_name(target);
  }
  TRY_ASSIGN(const wire::GoToStopReply reply,
             (call_tour<wire::GoToStopReply>(tour, "going to the stop", request, &wire::Tour::Stub::GoToStop)));
  fmt::print("to {}\n", printable(reply.name()));
  return Done{};
}

Status TourCommand::add() const {
  wire::AddStopRequest request;
  request.set_name(name);
  request.set_title(title);
  TRY_ASSIGN(const wire::AddStopReply reply,
             (call_tour<wire::AddStopReply>(tour, "adding a stop", request, &wire::Tour::Stub::AddStop)));
  fmt::print("added {}; 'cyclorama tour undo' removes it\n", printable(reply.name()));
  return Done{};
}

Status TourCommand::undo() const {
  TRY(call_tour<wire::UndoStopReply>(tour, "undoing", wire::UndoStopRequest(), &wire::Tour::Stub::UndoStop));
  return Done{};
}

Status TourCommand::fetch() const {
  TRY(call_tour<wire::FetchPicturesReply>(tour, "fetching pictures", wire::FetchPicturesRequest(),
                                          &wire::Tour::Stub::FetchPictures));
  fmt::print("the pictures are being fetched; 'cyclorama tour show' marks those that are kept\n");
  return Done{};
}

Status TourCommand::dim() const {
  wire::SetLampsRequest request;
  for (const std::string& text : lamps) {
    TRY_ASSIGN(const NamedNumber level, parse_named_number(text));
    (*request.mutable_levels())[level.name] = static_cast<float>(level.number);
  }
  TRY(call_tour<wire::SetLampsReply>(tour, "fading lamps", request, &wire::Tour::Stub::SetLamps));
  return Done{};
}

Status TourCommand::write() const {
  wire::SetCaptionsRequest request;
  request.set_next(captions.front() == "next");
  if (!request.next() && captions.front() != "none")
    request.mutable_languages()->Assign(captions.begin(), captions.end());
  TRY_ASSIGN(const wire::SetCaptionsReply reply,
             (call_tour<wire::SetCaptionsReply>(tour, "choosing captions", request, &wire::Tour::Stub::SetCaptions)));
  fmt::print("{}\n", reply.languages_size() == 0
                         ? "nothing is written on the wall"
                         : printable(fmt::format("written: {}", fmt::join(reply.languages(), ", ")), 200));
  return Done{};
}

Status TourCommand::check() const {
  const tour::TourFolder checked(folder);
  TRY_ASSIGN(const std::string text, checked.read());
  TRY_ASSIGN(tour::TourPlan plan, tour::parse_tour_plan(text, checked.file().string()));
  TRY(checked.read_captions(&plan));
  fmt::print("{} stops and {} ways; only a visit can tell whether they are in its walkable area\n", plan.stops.size(),
             plan.ways.size());
  return Done{};
}

Status TourCommand::import_tour() const {
  TRY_ASSIGN(const std::string text, read_text_file(svx, kMaxSvxBytes));
  TRY_ASSIGN(const tour::SvxImport import, tour::import_svx(text, svx, svx_tour - 1));
  const std::filesystem::path file = tour::TourFolder(folder).file();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("creating '{}': {}", folder, error.message()));
  if (std::filesystem::exists(file, error))
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is there already; choose another folder", file.string()));
  TRY(write_file_atomically(file, std::string_view(tour::to_toml(import.plan))));
  fmt::print("{}: {} stops\n", file.string(), import.plan.stops.size());
  for (const std::string& what : import.left_out) fmt::print("left out: {}\n", printable(what, 400));
  return Done{};
}

}  // namespace cyclorama::operations
