// SPDX-License-Identifier: Apache-2.0
/// Converts a primitive's vertex data for Mesh: finite, unit length, colours in sRGB code values.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Checks that `accessor` has a width and a component type that the specification allows for this kind of data, with or
/// without KHR_mesh_quantization (`quantized`). Sources: glTF 2.0, table 3.7.2.1; KHR_mesh_quantization, "Extending".
enum class GltfVertexKind { kPosition, kNormal, kTangent, kTexcoord, kColour, kJoints, kWeights };
Status check_vertex_format(const GltfAccessor& accessor, GltfVertexKind kind, bool quantized);

// Each of these functions charges the budget, reads `selection` and leaves the mesh's other parts alone. Preconditions:
// the format has been checked, the selection is inside the accessor, and positions and triangles are read first.

/// Also drops triangles whose corners are not finite.
Status read_positions(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// Replaces a normal without a direction by the normal of the surface around it.
Status read_normals(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// Leaves out all tangents if any has no direction.
Status read_tangents(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// `set` is 0 or 1.
Status read_texcoords(const GltfAccessor& accessor, const GltfSelection& selection, int set, GltfContext* context,
                      Mesh* mesh);
/// Converts linear values, clipped to [0, 1], to sRGB; alpha is 1 if absent.
Status read_colours(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);

}  // namespace cyclorama::scene
