// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "appliance/display/light_sharpener.h"
#include "appliance/display/mesh_buffers.h"
#include "appliance/display/panorama_texture.h"

namespace cyclorama::display {

/// Filter by which a moved frame is read between its pixels. A plain bilinear one would soften it.
enum class MeshFilter {
  kSharp,      ///< A filter of 12 pixels, at every refresh.
  kSharpened,  ///< Bilinear, in light that was sharpened once (light_sharpener.h); for software renderers.
};
[[nodiscard]] MeshFilter mesh_filter_for(const output::Gl& gl);

/// The pass between pass 1 and pass 2 for a visitor who walks: draws a frame's light again as a depth-tested mesh
/// (reprojection_mesh.h). Pass 2 is the same with and without it. Thread-bound to the GL context; borrows the Gl table.
/// Keeps its memory from one refresh to the next.
class ReprojectionPainter {
 public:
  /// Errors: kSystem if the driver's compiler refuses the shader, with its message.
  static Result<ReprojectionPainter> make(const output::Gl& gl, Texels texels, MeshFilter filter);

  /// Makes `panorama` show its light from an eye that has moved by `eye_m` (ReprojectionMesh::move()), until
  /// PanoramaTexture::show_unmoved(). Precondition: `mesh` belongs to the frame in `panorama`. Errors: kSystem if the
  /// graphics card refuses the buffers.
  Status draw(const ReprojectionMesh& mesh, const Eigen::Vector3d& eye_m, PanoramaTexture* panorama);
  /// Number of torn quads in the last picture.
  [[nodiscard]] std::size_t torn() const { return moved_.torn; }

 private:
  ReprojectionPainter(const output::Gl& gl, output::GlProgram program, std::optional<LightSharpener> sharpener);

  const output::Gl* gl_;
  output::GlProgram program_;
  std::optional<LightSharpener> sharpener_;  // For MeshFilter::kSharpened.
  MeshBuffers buffers_;
  GLint to_clip_ = -1;
  GLint per_texel_ = -1;
  GLint moved_across_ = -1;
  ReprojectedPicture moved_;
};

}  // namespace cyclorama::display
