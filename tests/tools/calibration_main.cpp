// SPDX-License-Identifier: Apache-2.0
// test-calibration: replaces a calibration as the calibrator does, or reads all of the one in use, for tests of power
// cuts. Run: test-calibration write|read FOLDER [DATE]
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string_view>

#include "appliance/calibration/calibration_file.h"
#include "tests/support/small_calibration.h"

int main(int argc, char** argv) {
  using namespace cyclorama;
  using namespace cyclorama::calibration;
  if (argc == 4 && std::string_view(argv[1]) == "write") {
    std::filesystem::create_directories(argv[2]);
    const Status saved = save_calibration(argv[2], small_calibration(argv[3]));
    if (!saved) fmt::print(stderr, "test-calibration: {}\n", saved.error().message());
    return saved ? 0 : 1;
  }
  if (argc == 3 && std::string_view(argv[1]) == "read") {
    const auto found = read_calibration(argv[2]);
    if (!found) {
      fmt::print(stderr, "test-calibration: {}\n", found.error().message());
      return 1;
    }
    fmt::print("{}\n", found->date);
    return 0;
  }
  fmt::print(stderr, "usage: test-calibration write|read FOLDER [DATE]\n");
  return 2;
}
