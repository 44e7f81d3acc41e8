// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/make_camera.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "common/base/text.h"
#include "drivers/camera/file/file_camera.h"
#include "drivers/camera/simulated/simulated_camera.h"

namespace cyclorama {
namespace {

using Made = Result<std::unique_ptr<Camera>>;

Error refuse(std::string_view spec, std::string_view what) {
  return Error(ErrorCode::kInvalidArgument, fmt::format("camera '{}': {}", printable(spec, 200), what));
}

/// Cuts `text` at the first `separator`; the rest is empty when there is none.
std::string_view cut(std::string_view* text, char separator) {
  const std::size_t at = text->find(separator);
  const std::string_view first = text->substr(0, at);
  *text = at == std::string_view::npos ? std::string_view() : text->substr(at + 1);
  return first;
}

Made make_file_camera(std::string_view spec, std::string_view argument, const Clock& clock) {
  FileCameraOptions options;
  const std::string path(cut(&argument, '?'));
  if (path.empty()) return refuse(spec, "names no file; write file:PATH");
  while (!argument.empty()) {
    std::string_view value = cut(&argument, '&');
    const std::string_view key = cut(&value, '=');
    if (key == "frames_per_second") {
      options.frames_per_second = parse_double(value);
      if (!options.frames_per_second) return refuse(spec, "frames_per_second must be a number");
    } else if (key == "loop" && (value == "yes" || value == "no")) {
      options.loop = value == "yes";
    } else {
      return refuse(spec, "knows the options frames_per_second=N and loop=yes or loop=no");
    }
  }
  return FileCamera::open(path, options, clock);
}

Made make_simulated_camera(std::string_view, std::string_view argument, const Clock& clock) {
  Simulation simulation;
  if (!argument.empty()) {
    TRY_ASSIGN(simulation, Simulation::read(std::string(argument)));
  }
  return std::unique_ptr<Camera>(std::make_unique<SimulatedCamera>(std::move(simulation), clock));
}

struct Kind {
  std::string_view name;
  Made (*make)(std::string_view spec, std::string_view argument, const Clock& clock);
};
constexpr std::array kKinds{Kind{"file", make_file_camera}, Kind{"simulated", make_simulated_camera}};

}  // namespace

Made make_camera(std::string_view spec, const Clock& clock) {
  std::string_view argument = spec;
  const std::string_view name = cut(&argument, ':');
  std::string known;
  for (const Kind& kind : kKinds) {
    if (kind.name == name) return kind.make(spec, argument, clock);
    known += fmt::format("{}{}:", known.empty() ? "" : ", ", kind.name);
  }
  return refuse(spec, fmt::format("no such kind of camera; the kinds are {}", known));
}

}  // namespace cyclorama
