// SPDX-License-Identifier: Apache-2.0
/// Light and exposure for scenes without light or with light of unknown strength.
#pragma once

#include "renderfarm/scene/found_settings.h"

namespace cyclorama::scene {

/// Adds light to a scene that has none. Sites and objects get a sky and a sun-like lamp; rooms get one lamp at the eye
/// and one above it. The lamps of a room are weaker if its surfaces reflect more light, so that white walls, which
/// light each other, are not overexposed and dark walls are visible. Emissive surfaces do not count as light, because
/// they light nothing else.
void add_light(const FoundSettings& found, Scene* scene);

/// Adds light for shadows, 4 % of white, to a scene that already has light. For an object, the light is a grey sky,
/// against which its outline shows; otherwise it is ambient light.
void add_shadow_light(const FoundSettings& found, Scene* scene);

/// Returns the exposure that gives the surfaces around the eye, lit by the lamps, medium brightness. It is needed
/// because files state between one and a hundred thousand candela for the same light. Assumes that the whole
/// environment is visible, and ignores shadows. Returns 1 if there is no light.
[[nodiscard]] double find_exposure(const FoundSettings& found, const Scene& scene);

/// Returns the mean share of light that the scene's surfaces reflect, in [0, 1], from samples of their colours.
[[nodiscard]] double mean_albedo(const Model& model);

}  // namespace cyclorama::scene
