// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/wand_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "common/base/check.h"
#include "common/base/file.h"
#include "kiosk/operator/wand_sheet.h"

namespace cyclorama::operations {

void WandCommand::add_to(CLI::App* app) {
  CLI::App& wand = *app->add_subcommand("wand", "Print a wand: a sheet to cut and fold");
  std::vector<std::string> names;
  for (const Paper& one : papers()) names.emplace_back(one.name);
  wand.add_option("--print", print, "Write a PDF: the sheet, and a page of instructions for folding it")
      ->type_name("FILE");
  wand.add_option("--describe", describe, "Write its wand.toml, to be corrected by measurements")->type_name("FILE");
  wand.add_option("--paper", paper, "Paper size; a larger one gives a larger wand, which is seen from farther away")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  wand.add_option("--number", number, "Number of the wand, different for each wand in a room")
      ->check(CLI::Range(0, kStandardWands - 1))
      ->capture_default_str();
}

Status WandCommand::run() const {
  if (!print && !describe) return Error(ErrorCode::kInvalidArgument, "add --print FILE, --describe FILE, or both");
  const auto found =
      std::find_if(papers().begin(), papers().end(), [&](const Paper& one) { return one.name == paper; });
  CHECK(found != papers().end());
  if (print) {
    TRY(write_file_atomically(*print, std::string_view(to_pdf(wand_sheet(number, *found)))));
    std::printf("%s: print it at 100 %% and fold it as its second page says\n", print->c_str());
  }
  if (describe) {
    TRY(write_file_atomically(*describe, std::string_view(wand_toml(standard_wand(number, card_on(*found))))));
    std::printf("%s: for cyclorama-tracker --wand\n", describe->c_str());
  }
  return Done{};
}

}  // namespace cyclorama::operations
