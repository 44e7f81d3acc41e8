// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/trade_plan.h"

#include <algorithm>

namespace cyclorama {
namespace {

class Plan {
 public:
  void add(const std::string& knob, const render::PictureQuality& quality) {
    const auto same = [&](const PlannedPoint& point) { return point.quality == quality; };
    if (std::none_of(points_.begin(), points_.end(), same)) points_.push_back({knob, quality});
  }
  /// Varies one setting alone: `turn` sets it in a copy of `from`.
  template <typename Value, typename Turn>
  void sweep(const std::string& knob, const render::PictureQuality& from, const std::vector<Value>& values,
             const Turn& turn) {
    for (const Value& value : values) {
      render::PictureQuality quality = from;
      turn(quality, value);
      add(knob, quality);
    }
  }
  [[nodiscard]] std::vector<PlannedPoint> points() && { return std::move(points_); }

 private:
  std::vector<PlannedPoint> points_;
};

void add_how_it_is_sent(Plan* plan, bool quick) {
  const std::vector<int> qualities = quick ? std::vector{60, 95} : std::vector{40, 60, 75, 90, 95, 98};
  for (const bool subsample : {true, false}) {
    render::PictureQuality from = trade_base();
    from.subsample_chroma = subsample;
    plan->add("jpeg", from);
    plan->sweep("jpeg", from, qualities,
                [](render::PictureQuality& quality, int value) { quality.jpeg_quality = value; });
  }
}

void add_knobs_alone(Plan* plan, bool quick) {
  using Ints = std::vector<int>;
  using Floats = std::vector<float>;
  const render::PictureQuality base = trade_base();
  plan->sweep("samples", base, quick ? Ints{1, 16} : Ints{1, 2, 8, 16, 32, 64, 128},
              [](render::PictureQuality& quality, int value) { quality.render.samples = value; });
  plan->sweep("bounces", base, quick ? Ints{0, 4} : Ints{0, 1, 3, 4, 8},
              [](render::PictureQuality& quality, int value) { quality.render.bounces = value; });
  plan->sweep("light samples", base, quick ? Ints{4} : Ints{2, 4, 8},
              [](render::PictureQuality& quality, int value) { quality.render.light_samples = value; });
  plan->sweep("firefly limit", base, quick ? Floats{1.0f} : Floats{0.25f, 1.0f, 4.0f, 16.0f},
              [](render::PictureQuality& quality, float value) { quality.render.firefly_limit = value; });
  plan->sweep("scale", base, quick ? std::vector{0.5} : std::vector{0.25, 0.35, 0.5, 0.71, 0.85},
              [](render::PictureQuality& quality, double value) { quality.scale = value; });
  plan->sweep("denoiser", base, std::vector{true},
              [](render::PictureQuality& quality, bool value) { quality.denoise = value; });
  render::PictureQuality many = base;
  many.render.samples = quick ? 32 : 128;  // Adaptive sampling reduces this number.
  plan->sweep("adaptive", many, quick ? Floats{0.02f} : Floats{0.04f, 0.02f, 0.01f, 0.005f},
              [](render::PictureQuality& quality, float value) { quality.render.adaptive_error = value; });
}

void add_knobs_together(Plan* plan, bool quick) {
  const std::vector<int> samples = quick ? std::vector{1, 4, 16} : std::vector{1, 2, 4, 8, 16, 32, 64};
  const std::vector<int> bounces = quick ? std::vector{0, 2} : std::vector{0, 1, 2, 4};
  const std::vector<double> scales = quick ? std::vector{0.5, 1.0} : std::vector{0.35, 0.5, 0.71, 1.0};
  constexpr int kDenoiserUpTo = 16;  // The denoiser is intended for few samples.
  for (const double scale : scales) {
    for (const int bounce : bounces) {
      for (const int sample : samples) {
        render::PictureQuality quality = trade_base();
        quality.scale = scale;
        quality.render.bounces = bounce;
        quality.render.samples = sample;
        plan->add("together", quality);
        quality.denoise = true;
        if (sample <= kDenoiserUpTo) plan->add("together", quality);
      }
    }
  }
}

}  // namespace

render::PictureQuality trade_base() {
  render::PictureQuality base;
  base.render.samples = 4;
  base.render.bounces = 2;
  return base;
}

std::vector<PlannedPoint> trade_plan(bool quick) {
  Plan plan;
  plan.add("base", trade_base());
  add_how_it_is_sent(&plan, quick);
  add_knobs_alone(&plan, quick);
  add_knobs_together(&plan, quick);
  return std::move(plan).points();
}

}  // namespace cyclorama
