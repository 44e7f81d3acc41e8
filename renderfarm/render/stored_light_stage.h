// SPDX-License-Identifier: Apache-2.0
/// Ends paths where stored light contains all the light that they would find, before anything else is computed for
/// them.
#pragma once

#include "renderfarm/render/kernel.h"

namespace cyclorama::render {

/// Returns true if rays of `view` may end at stored light by end_at_stored_light(). Views that request features are
/// shaded completely.
[[nodiscard]] bool ends_at_stored_light(const TraceView& view);

/// Ends the paths whose rays in batch.current() hit a `plain` surface with stored light: such a surface shows its
/// colour times the light and that of the eye lamp, so BSDFs and random numbers are not needed. The other rays stay, in
/// the same order.
/// Precondition: ends_at_stored_light(), and the rays are traced.
void end_at_stored_light(const TraceScene& scene, const TraceView& view, PathBatch& batch);

}  // namespace cyclorama::render
