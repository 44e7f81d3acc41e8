// SPDX-License-Identifier: Apache-2.0
/// Optics, cameras, walls and rooms as they are sold and built, beyond what the calibration's own models describe. Each
/// kind can be added alone, so that its effect can be measured. Contains the truth: see truth.h for its permitted users.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "drivers/simulated/museum/flaws.h"

namespace cyclorama::simulated {

/// Names of the kinds:
///
///   decentred     projector lenses off their axis: tangential distortion, and a shift of the picture by 2 %
///   residue       waves of up to .6 px at 1080 rows that no lens of Brown has, in projectors and the camera
///   colour        red and blue pictures that are larger or smaller than the green one, by .5 px at the rim
///   focus         projectors focused in the middle of a curved wall, blurred by up to 1.5 px beside it
///   wheel         gamma of 2.2 to 2.6, and a white segment of 30 to 60 %
///   drift         pictures that move by .5 px within the first half hour
///   webcam        gamma .45 and a tone curve, noise reduction, sharpening, Motion JPEG at 80, 8 bits, rolling shutter
///   exposure      a camera that exposes as it likes
///   wall          seams of paint, a door, plaster, a sheen
///   daylight      light of up to 20 lux that comes and goes within minutes
///   mount         a camera that vibrates by .1 px and creeps by 6 px an hour
[[nodiscard]] const std::vector<std::string>& as_sold_kinds();

/// Adds one kind, drawn at random. Errors: kInvalidArgument for an unknown one.
Status add_as_sold(const RandomStream& draws, std::string_view kind, MuseumTruth* truth);

}  // namespace cyclorama::simulated
