// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/mesh_buffers.h"

#include <cstddef>

namespace cyclorama::display {

MeshBuffers::MeshBuffers(const output::Gl& gl) : gl_(&gl), array_(gl), vertices_(gl), indices_(gl) {
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  const auto attribute = [&](GLuint index, GLint floats, std::size_t offset) {
    gl.EnableVertexAttribArray(index);
    // GL's convention: an offset into the bound buffer, passed as a pointer.
    gl.VertexAttribPointer(index, floats, GL_FLOAT, GL_FALSE, sizeof(ReprojectedVertex),
                           reinterpret_cast<const void*>(offset));  // NOLINT(performance-no-int-to-ptr)
  };
  attribute(kTarget, 3, offsetof(ReprojectedVertex, across_px));
  attribute(kSource, 2, offsetof(ReprojectedVertex, source_across_px));
}

void MeshBuffers::upload(const std::vector<ReprojectedVertex>& vertices) {
  gl_->BindVertexArray(array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(vertices[0])), vertices.data(),
                  GL_STREAM_DRAW);
}

void MeshBuffers::draw(std::span<const std::uint32_t> indices) const {
  if (indices.empty()) return;
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                  GL_STREAM_DRAW);
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(indices.size()), GL_UNSIGNED_INT, nullptr);
}

}  // namespace cyclorama::display
