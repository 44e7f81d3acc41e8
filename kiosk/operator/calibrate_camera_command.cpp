// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/calibrate_camera_command.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "common/base/check.h"
#include "common/base/file.h"
#include "kiosk/operator/board_sheet.h"

namespace cyclorama::operations {
namespace {

constexpr const char* kName = "calibrate-camera";
constexpr const char* kProgram = "cyclorama-calibrate-camera";

/// Returns the path of the program beside this one or, if there is none, the name to search along PATH.
std::string program_path() {
  std::error_code problem;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", problem).parent_path() / kProgram;
  return !problem && std::filesystem::exists(here, problem) ? here.string() : kProgram;
}

}  // namespace

void CalibrateCameraCommand::add_to(CLI::App* app) {
  CLI::App& command = *app->add_subcommand(
      kName, "Calibrate a camera's lens: print the board, and make camera.json from pictures of it");
  std::vector<std::string> names;
  for (const Paper& one : papers()) names.emplace_back(one.name);
  command.add_option("--print", print, "Write a PDF: the board, and a page of instructions for photographing it")
      ->type_name("FILE");
  command.add_option("--paper", paper, "Paper size; a larger one gives a larger board, for cameras far away")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  command.allow_extras();
  command.footer(
      "All other options are those of cyclorama-calibrate-camera: --pictures, --camera, --out; see its --help.");
}

Status CalibrateCameraCommand::run(const CLI::App& app) const {
  if (print) {
    const auto found =
        std::find_if(papers().begin(), papers().end(), [&](const Paper& one) { return one.name == paper; });
    CHECK(found != papers().end());
    TRY(write_file_atomically(*print, std::string_view(to_pdf(board_sheet(*found)))));
    std::printf("%s: print it at 100 %% and go on as its second page says\n", print->c_str());
    return Done{};
  }
  std::vector<std::string> words = app.get_subcommand(kName)->remaining();
  words.insert(words.begin(), kProgram);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(program_path().c_str(), arguments.data());
  return Error(ErrorCode::kNotFound, std::string(kProgram) + " does not start: " + std::strerror(errno) +
                                         "; install cyclorama-museum on this machine");
}

}  // namespace cyclorama::operations
