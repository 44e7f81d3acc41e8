// SPDX-License-Identifier: Apache-2.0
/// Light and exposure for scenes that come without any, or with light of unknown strength.
#pragma once

#include "renderfarm/scene/found_settings.h"

namespace cyclorama::scene {

/// Adds light to a scene that has none: the sky and a sun-like lamp outdoors and for objects, one lamp at the eye and
/// one above it in rooms. The more the surfaces of a room reflect, the weaker are its lamps, so that white walls, which
/// light each other, are not overexposed and dark ones are visible. Emissive surfaces do not count as light, since they
/// light nothing else.
void add_light(const FoundSettings& found, Scene* scene);

/// Adds what shadows receive to a scene with light of its own: 4 % of white. Around an object it comes from a grey
/// surround, which shows its outline; elsewhere it is ambient light.
void add_shadow_light(const FoundSettings& found, Scene* scene);

/// Returns the exposure that gives surfaces around the eye, lit by the lamps, middle brightness: for the same light,
/// files state anything from one to a hundred thousand candela. Counts the environment as wholly visible and ignores
/// shadows. Returns 1 if there is no light.
[[nodiscard]] double find_exposure(const FoundSettings& found, const Scene& scene);

/// Returns the mean part of the light that the scene's surfaces reflect, from samples of their colours. In [0, 1].
[[nodiscard]] double mean_albedo(const Model& model);

}  // namespace cyclorama::scene
