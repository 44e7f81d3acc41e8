// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "appliance/display/reprojection_mesh.h"
#include "drivers/output/gl_objects.h"

namespace cyclorama::display {

/// The vertices of a ReprojectedPicture on the card, as attributes of a vertex shader. Thread-bound to the GL context;
/// borrows the Gl table.
class MeshBuffers {
 public:
  static constexpr GLuint kTarget = 0;  ///< Attribute vec3: across_px, down_px, inverse_m.
  static constexpr GLuint kSource = 1;  ///< Attribute vec2: source_across_px, source_down_px.

  /// Leaves its vertex array bound, so that the caller can add attributes.
  explicit MeshBuffers(const output::Gl& gl);

  /// Binds the vertex array and fills it.
  void upload(const std::vector<ReprojectedVertex>& vertices);
  /// Precondition: since the last upload(), no other vertex array was bound.
  void draw(std::span<const std::uint32_t> indices) const;

 private:
  const output::Gl* gl_;
  output::GlVertexArray array_;
  output::GlBuffer vertices_;
  output::GlBuffer indices_;
};

}  // namespace cyclorama::display
