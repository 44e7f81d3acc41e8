// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/bsdf/albedo_table.h"

#include "renderfarm/render/bsdf/fresnel.h"
#include "renderfarm/render/bsdf/microfacet.h"

namespace cyclorama::render {
namespace {

/// Returns the cosine of a column. Columns are spaced evenly in the square root of the cosine, because values change
/// faster towards grazing angles.
float cosine_of(int column, int columns) {
  constexpr float kGrazing = 1e-4f;
  const float root = static_cast<float>(column) / static_cast<float>(columns - 1);
  return std::max(kGrazing, root * root);
}

/// Returns the mean over a cosine-weighted hemisphere of a function that is linear, between columns, in u, the square
/// root of the cosine. The weight is 4 u³ du; three-point Gauss-Legendre quadrature integrates the product exactly.
template <typename At>
float mean_of_columns(int columns, const At& at) {
  constexpr std::array<float, 3> kPlaces = {0.1127016654f, 0.5f, 0.8872983346f};
  constexpr std::array<float, 3> kWeights = {5.0f / 18.0f, 8.0f / 18.0f, 5.0f / 18.0f};
  float sum = 0.0f;
  for (int column = 0; column + 1 < columns; ++column) {
    for (std::size_t i = 0; i < 3; ++i) {
      const float u = (static_cast<float>(column) + kPlaces[i]) / static_cast<float>(columns - 1);
      sum += at(column, kPlaces[i]) * (kWeights[i] * 4.0f * u * u * u / static_cast<float>(columns - 1));
    }
  }
  return sum;
}

/// Calls weight(wo, h, facets, share) for visible normals on a uniform grid; the shares sum to 1.
template <typename Weight>
void for_visible_normals(float cosine, float alpha, int steps, const Weight& weight) {
  const Vec3 wo(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
  const Microfacets facets(alpha, wo);
  const float step = 1.0f / static_cast<float>(steps);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const Vec2 u((static_cast<float>(i) + 0.5f) * step, (static_cast<float>(j) + 0.5f) * step);
      weight(wo, facets.sample(u, false), facets, step * step);
    }
  }
}

/// Returns the shadowing of light towards the cosine `cos_i`, for normals visible from wo.
float shadowing(const Microfacets& facets, float cos_i) {
  return facets.visibility(cos_i) * cos_i / facets.reflected_pdf(1.0f, false);
}

float smooth_coat(float cosine) { return kCoatF0 + (1.0f - kCoatF0) * schlick(cosine); }

BounceAlbedo bounce_albedo(float cosine, float alpha) {
  BounceAlbedo sum{0.0f, 0.0f, 0.0f, 0.0f};
  for_visible_normals(cosine, alpha, 24, [&](const Vec3& wo, const Vec3& h, const Microfacets& facets, float part) {
    const float o_h = wo.dot(h);
    const float cos_i = 2.0f * o_h * h.z() - wo.z();
    const float left = cos_i > 0.0f ? shadowing(facets, cos_i) : 0.0f;
    const float grazing = schlick(o_h);
    sum.low += part * left * (1.0f - grazing);
    sum.high += part * left * grazing;
    sum.lost += part * std::max(0.0f, 1.0f - left);
    sum.darker += part * left * std::max(0.0f, smooth_coat(cos_i) - smooth_coat(wo.z()));
  });
  return sum;
}

/// Returns the share of light that one bounce at the facets of glass loses.
float glass_lost(float cosine, float alpha, float eta) {
  float sum = 0.0f;
  for_visible_normals(cosine, alpha, 14, [&](const Vec3& wo, const Vec3& h, const Microfacets& facets, float part) {
    const float o_h = wo.dot(h);
    float beyond = 0.0f;
    const float reflectance = dielectric_reflectance(o_h, eta, &beyond);
    const float up = 2.0f * o_h * h.z() - wo.z();
    const float down = wo.z() / eta - (o_h / eta - beyond) * h.z();
    const float up_lost = up > 0.0f ? 1.0f - shadowing(facets, up) : 1.0f;
    const float down_lost = down > 0.0f ? 1.0f - shadowing(facets, down) : 1.0f;
    sum += part * std::max(0.0f, reflectance * up_lost + (1.0f - reflectance) * down_lost);
  });
  return sum;
}

AlbedoRow::Table make_table() {
  AlbedoRow::Table table;
  for (int width = 0; width < AlbedoRow::kWidths; ++width) {
    const float root = static_cast<float>(width) / static_cast<float>(AlbedoRow::kWidths - 1);
    AlbedoRow::Row& row = table.rows[static_cast<std::size_t>(width)];
    for (int column = 0; column < AlbedoRow::kCosines; ++column) {
      const float cosine = cosine_of(column, AlbedoRow::kCosines);
      const float grazing = schlick(cosine);
      row[static_cast<std::size_t>(column)] =
          width == 0 ? BounceAlbedo{1.0f - grazing, grazing, 0.0f, 0.0f} : bounce_albedo(cosine, root * root);
    }
    const auto mean_of = [&row](float BounceAlbedo::*number) {
      return mean_of_columns(AlbedoRow::kCosines, [&](int column, float part) {
        const float a = row[static_cast<std::size_t>(column)].*number;
        return a + (row[static_cast<std::size_t>(column) + 1].*number - a) * part;
      });
    };
    table.means[static_cast<std::size_t>(width)] = {mean_of(&BounceAlbedo::low), mean_of(&BounceAlbedo::high),
                                                    mean_of(&BounceAlbedo::lost), mean_of(&BounceAlbedo::darker)};
  }
  return table;
}

GlassLoss::Table make_glass_table() {
  GlassLoss::Table table;
  for (int i = 0; i < GlassLoss::kIors; ++i) {
    const float place = static_cast<float>(i) / static_cast<float>(GlassLoss::kIors - 1);
    const float root = std::min(place * place, 0.999f);
    const float ior = (1.0f + root) / (1.0f - root);
    for (int width = 0; width < GlassLoss::kWidths; ++width) {
      const float rough = static_cast<float>(width) / static_cast<float>(GlassLoss::kWidths - 1);
      for (std::size_t side = 0; side < 2; ++side) {
        GlassLoss::Row& row = table[static_cast<std::size_t>(i)][static_cast<std::size_t>(width)][side];
        for (int column = 0; column < GlassLoss::kCosines; ++column) {
          const float cosine = cosine_of(column, GlassLoss::kCosines);
          row[static_cast<std::size_t>(column)] =
              width == 0 ? 0.0f : glass_lost(cosine, rough * rough, side == 0 ? ior : 1.0f / ior);
        }
        row[GlassLoss::kCosines] = mean_of_columns(GlassLoss::kCosines, [&](int column, float part) {
          const float a = row[static_cast<std::size_t>(column)];
          return a + (row[static_cast<std::size_t>(column) + 1] - a) * part;
        });
      }
    }
  }
  return table;
}

}  // namespace

const AlbedoRow::Table& AlbedoRow::table() {
  static const Table made = make_table();
  return made;
}

GlassLoss::GlassLoss(float alpha, float ior) {
  static const Table made = make_glass_table();
  const auto split = [](float place, int count, std::size_t* ret_part) {
    const float at = std::clamp(place, 0.0f, 1.0f) * static_cast<float>(count - 1);
    const int below = std::min(static_cast<int>(at), count - 2);
    *ret_part = static_cast<std::size_t>(below);
    return at - static_cast<float>(below);
  };
  std::size_t i = 0;
  std::size_t width = 0;
  const float i_part = split(std::sqrt((ior - 1.0f) / (ior + 1.0f)), kIors, &i);
  const float width_part = split(std::sqrt(alpha), kWidths, &width);
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < rows_[side].size(); ++k) {
      const auto across = [&](std::size_t at) {
        return made[at][width][side][k] + (made[at][width + 1][side][k] - made[at][width][side][k]) * width_part;
      };
      rows_[side][k] = across(i) + (across(i + 1) - across(i)) * i_part;
    }
  }
}

}  // namespace cyclorama::render
