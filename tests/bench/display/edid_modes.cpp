// SPDX-License-Identifier: Apache-2.0
// Prints what a head would do with a projector's EDID, for each file that is named: the mode that it would be driven
// with, or the sentence that states why only a common mode is left.
#include <fmt/format.h>

#include "common/edid/edid.h"
#include "drivers/output/drm/mode_choice.h"

int main(int argc, char** argv) {
  using namespace cyclorama;
  for (int i = 1; i < argc; ++i) {
    // Printed first, so that a crash names its file.
    fmt::print("{}\t", argv[i]);
    std::fflush(stdout);
    const auto edid = read_edid_to_drive(argv[i]);
    if (edid) {
      const auto modes = output::modes_to_try(output::modes_of(edid->timings), {});
      fmt::print("mode\t{}{}\t{} timings\n", output::text_of(modes.front()),
                 (modes.front().flags & DRM_MODE_FLAG_INTERLACE) != 0 ? "i" : "", edid->timings.size());
    } else {
      fmt::print("sentence\t{}\n", edid.error().message());
    }
  }
  return 0;
}
