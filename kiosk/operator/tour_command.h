// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::operations {

/// cyclorama tour: lists the stops of the visit, leads to them, adds and removes them, and checks or imports a tour.
struct TourCommand {
  std::string tour = "[::1]:7403";
  std::string language;
  std::string target;  ///< "next", "previous" or a stop's name.
  std::string name;
  std::string title;
  std::vector<std::string> lamps;     ///< GROUP=LEVEL.
  std::vector<std::string> captions;  ///< Languages' tags, "next" or "none".
  std::string folder;
  std::string svx;
  std::size_t svx_tour = 1;

  void add_to(CLI::App* app);
  /// Runs the subcommand that was given. Errors: those of museum.proto, parse_tour_plan() and import_svx().
  [[nodiscard]] Status run(const CLI::App& app) const;

 private:
  [[nodiscard]] Status show() const;
  [[nodiscard]] Status go_to() const;
  [[nodiscard]] Status add() const;
  [[nodiscard]] Status undo() const;
  [[nodiscard]] Status fetch() const;
  [[nodiscard]] Status dim() const;
  [[nodiscard]] Status write() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] Status import_tour() const;
};

}  // namespace cyclorama::operations
