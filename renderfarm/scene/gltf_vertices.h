// SPDX-License-Identifier: Apache-2.0
/// Converts a primitive's vertex data to that of Mesh: finite positions, unit vectors, and colours in sRGB code values.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/model.h"

namespace cyclorama::scene {

/// Kind of vertex data.
enum class GltfVertexKind { kPosition, kNormal, kTangent, kTexcoord, kColour, kJoints, kWeights };
/// Checks that `accessor` has a width and a component type that the specification allows for this kind of data, with or
/// without KHR_mesh_quantization (`quantized`). Sources: glTF 2.0, table 3.7.2.1; KHR_mesh_quantization, "Extending".
Status check_vertex_format(const GltfAccessor& accessor, GltfVertexKind kind, bool quantized);

// Each of these functions charges the budget, reads `selection` and does not change other parts of the mesh.
// Preconditions: the format has been checked, the selection is inside the accessor, and positions and triangles are
// read first.

/// Reads positions, and drops triangles whose corners are not finite.
Status read_positions(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// Returns true if all positions are usable; for points, which read_positions() would move.
[[nodiscard]] bool are_positions_usable(const GltfAccessor& accessor, const GltfSelection& selection);
/// Reads normals; one without a direction is replaced by the normal of the surface around it.
Status read_normals(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// Reads tangents; all are left out if any has no direction.
Status read_tangents(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// Reads texture coordinates; `set` is 0 or 1.
Status read_texcoords(const GltfAccessor& accessor, const GltfSelection& selection, int set, GltfContext* context,
                      Mesh* mesh);
/// Reads colours; linear values are clipped to [0, 1] and converted to sRGB, and alpha is 1 if absent.
Status read_colours(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);

}  // namespace cyclorama::scene
