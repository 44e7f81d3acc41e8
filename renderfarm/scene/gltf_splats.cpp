// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_splats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "renderfarm/scene/gltf_accessor.h"
#include "renderfarm/scene/gltf_transform.h"
#include "renderfarm/scene/spz.h"

namespace cyclorama::scene {
namespace {

constexpr const char* kExtension = "KHR_gaussian_splatting";
constexpr const char* kSpz = "KHR_gaussian_splatting_compression_spz_2";

/// Reads the attributes of one primitive. Borrows its arguments. Thread-bound.
class SplatReader {
 public:
  SplatReader(GltfDocument* document, GltfContext* context, const GltfObject& attributes)
      : document_(document), context_(context), attributes_(attributes) {}

  Result<SplatCloud> read(const std::string& place) {
    TRY_ASSIGN(const auto positions, required<3>("POSITION"));
    count_ = positions.size();
    TRY_ASSIGN(const auto rotations, required<4>("KHR_gaussian_splatting:ROTATION"));
    TRY_ASSIGN(auto scales, required<3>("KHR_gaussian_splatting:SCALE"));
    TRY_ASSIGN(const auto opacities, required<1>("KHR_gaussian_splatting:OPACITY"));
    SplatCloud cloud;
    TRY_ASSIGN(const auto harmonics, read_harmonics(&cloud.degree));
    TRY(context_->budget.take(place, *count_, bytes_per_splat(cloud.degree)));
    make_linear(&scales, place);
    std::vector<std::array<float, 3>> coefficients(harmonics.size());
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < *count_; ++i) {
      SplatValues values;
      values.position = Eigen::Vector3f(positions[i].data()).cast<double>();
      values.scale = Eigen::Vector3f(scales[i].data()).cast<double>();
      values.rotation =
          Eigen::Quaternionf(rotations[i][3], rotations[i][0], rotations[i][1], rotations[i][2]).cast<double>();
      values.opacity = double{opacities[i][0]};
      for (std::size_t k = 0; k < harmonics.size(); ++k) coefficients[k] = harmonics[k][i];
      if (!add_splat(values, coefficients, &cloud)) ++left_out;
    }
    if (left_out > 0) context_->notes.add(note_of_left_out(left_out), place);
    return cloud;
  }

 private:
  template <std::size_t kWidth>
  using Values = std::vector<std::array<float, kWidth>>;

  template <std::size_t kWidth>
  Result<std::optional<Values<kWidth>>> optional(const char* semantic) {
    TRY_ASSIGN(const std::optional<std::size_t> index, document_->index(attributes_, semantic, "accessors"));
    if (!index) return std::optional<Values<kWidth>>();
    TRY_ASSIGN(const GltfAccessor accessor, read_accessor(document_, *index, &context_->budget));
    if (accessor.width != static_cast<int>(kWidth)) return attributes_.damaged(semantic, "has the wrong type");
    if (count_ && accessor.count != *count_) {
      return attributes_.damaged(semantic, fmt::format("has {} values for {} splats", accessor.count, *count_));
    }
    TRY(context_->budget.take(accessor.place, accessor.count, kWidth * sizeof(float)));
    Values<kWidth> values = read_floats<kWidth>(accessor, GltfSelection::all(accessor.count));
    context_->budget.give_back(accessor.count, kWidth * sizeof(float));
    return std::optional(std::move(values));
  }
  template <std::size_t kWidth>
  Result<Values<kWidth>> required(const char* semantic) {
    TRY_ASSIGN(std::optional<Values<kWidth>> values, optional<kWidth>(semantic));
    if (!values) return attributes_.damaged(semantic, "is missing");
    return *std::move(values);
  }

  /// Returns one entry for each coefficient, up to the last degree whose coefficients are complete.
  Result<std::vector<Values<3>>> read_harmonics(int* ret_degree) {
    std::vector<Values<3>> harmonics;
    for (int degree = 0; degree <= kMaxSplatDegree; ++degree) {
      std::vector<Values<3>> of_degree;
      for (int i = 0; i <= 2 * degree; ++i) {
        const std::string semantic = fmt::format("KHR_gaussian_splatting:SH_DEGREE_{}_COEF_{}", degree, i);
        TRY_ASSIGN(std::optional<Values<3>> values, optional<3>(semantic.c_str()));
        if (values) of_degree.push_back(*std::move(values));
      }
      if (of_degree.size() < 2 * static_cast<std::size_t>(degree) + 1) break;
      *ret_degree = degree;
      std::move(of_degree.begin(), of_degree.end(), std::back_inserter(harmonics));
    }
    if (!harmonics.empty()) return harmonics;
    TRY_ASSIGN(Values<3> colours, read_fallback_colours());
    harmonics.push_back(std::move(colours));
    return harmonics;
  }

  /// Reads COLOR_0, which files have for programs that show points instead of splats.
  Result<Values<3>> read_fallback_colours() {
    TRY_ASSIGN(const std::optional<std::size_t> index, document_->index(attributes_, "COLOR_0", "accessors"));
    if (!index) return attributes_.damaged("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "is missing");
    TRY_ASSIGN(const GltfAccessorShape shape, read_accessor_shape(*document_, *index));
    Values<3> colours;
    if (shape.width == 4) {
      TRY_ASSIGN(const Values<4> with_alpha, required<4>("COLOR_0"));
      for (const auto& c : with_alpha) colours.push_back({c[0], c[1], c[2]});
    } else {
      TRY_ASSIGN(colours, required<3>("COLOR_0"));
    }
    for (std::array<float, 3>& colour : colours) {
      for (float& channel : colour) channel = coefficient_of(double{channel});
    }
    return colours;
  }

  /// Converts `scales` to linear values if they are logarithms. Scales were logarithms in drafts of the extension;
  /// those of small splats are negative.
  void make_linear(Values<3>* scales, const std::string& place) {
    const bool are_logarithms = std::any_of(scales->begin(), scales->end(), [](const std::array<float, 3>& scale) {
      return scale[0] < 0.0f || scale[1] < 0.0f || scale[2] < 0.0f;
    });
    if (!are_logarithms) return;
    context_->notes.add("splats have negative scales: taken as logarithms, as in drafts of the extension", place);
    for (std::array<float, 3>& scale : *scales) {
      for (float& part : scale) part = std::exp(part);
    }
  }

  GltfDocument* document_;
  GltfContext* context_;
  const GltfObject& attributes_;
  std::optional<std::size_t> count_;
};

Result<SplatCloud> read_primitive(GltfDocument* document, GltfContext* context, const GltfObject& primitive,
                                  const GltfObject& splatting) {
  TRY_ASSIGN(const std::optional<GltfObject> spz, splatting.extension(kSpz));
  if (spz) {
    TRY_ASSIGN(const std::size_t index, document->required_index(*spz, "bufferView", "bufferViews"));
    TRY_ASSIGN(const GltfBufferView view, document->buffer_view(index));
    std::size_t left_out = 0;
    Result<SplatCloud> cloud = decode_spz(view.bytes, context->budget.left_bytes(), &left_out);
    if (!cloud) return std::move(cloud).error().while_doing(view.place);
    TRY(context->budget.take(view.place, cloud->size(), bytes_per_splat(cloud->degree)));
    if (left_out > 0) context->notes.add(note_of_left_out(left_out), view.place);
    return cloud;
  }
  TRY_ASSIGN(const std::optional<GltfObject> attributes, primitive.object("attributes"));
  if (!attributes) return primitive.damaged("attributes", "is missing");
  return SplatReader(document, context, *attributes).read(primitive.place());
}

/// Notes a kernel or colour space that is not supported and shown as the default. Returns true if colours are linear.
Result<bool> check_kind(const GltfObject& splatting, GltfContext* context) {
  TRY_ASSIGN(const std::string kernel, splatting.text_or("kernel", "ellipse"));
  if (kernel != "ellipse") {
    context->notes.add(fmt::format("splats have the kernel '{}': shown as ellipses", printable(kernel)),
                       splatting.place());
  }
  TRY_ASSIGN(const std::string space, splatting.text_or("colorSpace", "srgb_rec709_display"));
  if (space != "srgb_rec709_display" && space != "lin_rec709_display") {
    context->notes.add(fmt::format("splats have the colour space '{}': taken as sRGB", printable(space)),
                       splatting.place());
  }
  return space == "lin_rec709_display";
}

}  // namespace

Result<bool> is_gltf_splats(const GltfObject& primitive) {
  TRY_ASSIGN(const std::optional<GltfObject> splatting, primitive.extension(kExtension));
  return splatting.has_value();
}

Status add_gltf_splats(GltfDocument* document, GltfContext* context, std::size_t mesh,
                       const Eigen::Affine3d& T_model_mesh, Model* ret_model) {
  TRY_ASSIGN(const GltfObject object, document->item("meshes", mesh));
  TRY_ASSIGN(const GltfArray primitives, object.array("primitives"));
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    TRY_ASSIGN(const GltfObject primitive, primitives.object(i));
    TRY_ASSIGN(const std::optional<GltfObject> splatting, primitive.extension(kExtension));
    if (!splatting) continue;
    if (!T_model_mesh.matrix().allFinite() || !is_invertible(T_model_mesh)) {
      context->notes.add("a node is scaled to nothing: not shown", primitive.place());
      continue;
    }
    TRY_ASSIGN(SplatCloud cloud, read_primitive(document, context, primitive, *splatting));
    TRY_ASSIGN(cloud.is_linear, check_kind(*splatting, context));
    if (cloud.size() == 0) continue;
    cloud.name = object.name();
    cloud.T_model_cloud = T_model_mesh;
    ret_model->splats.push_back(std::move(cloud));
  }
  return Done{};
}

}  // namespace cyclorama::scene
