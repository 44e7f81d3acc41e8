// SPDX-License-Identifier: Apache-2.0
/// A primitive's vertex data as Mesh wants it: finite, unit length, and in sRGB code values.
#pragma once

#include "common/base/result.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_context.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Is `accessor` of the width and a component type that the specification allows for this kind of data, when
/// `quantized` by KHR_mesh_quantization or not? Sources: glTF 2.0, table 3.7.2.1; KHR_mesh_quantization, "Extending".
enum class GltfVertexKind { kPosition, kNormal, kTangent, kTexcoord, kColour };
Status check_vertex_format(const GltfAccessor& accessor, GltfVertexKind kind, bool quantized);

// Each of these charges the budget, reads `selection` and leaves the mesh's other parts alone. Preconditions: the
// format is checked, the selection is inside the accessor; positions and triangles come first.

/// Also drops triangles whose corners are not finite.
Status read_positions(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// A normal without a direction is replaced by that of the surface around it.
Status read_normals(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// All are left out when some are no directions.
Status read_tangents(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);
/// `set` is 0 or 1.
Status read_texcoords(const GltfAccessor& accessor, const GltfSelection& selection, int set, GltfContext* context,
                      Mesh* mesh);
/// Linear light, clipped to [0, 1], to sRGB; alpha 1 where there is none.
Status read_colours(const GltfAccessor& accessor, const GltfSelection& selection, GltfContext* context, Mesh* mesh);

}  // namespace cyclorama
