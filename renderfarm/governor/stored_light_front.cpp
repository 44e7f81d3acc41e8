// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/stored_light_front.h"

namespace cyclorama::governor {

ParetoFront stored_light_front(int bounces) {
  // Measured with `./bench.sh light-equal-error` for the generated grotto of 1 M triangles.
  struct Row {
    double scale;
    int samples;
    bool stored_light;
    double cpu_us_per_px;
    double relmse;
  };
  constexpr Row kRows[] = {{0.5, 1, true, 0.12, 0.03},   {0.71, 1, true, 0.23, 0.019},
                           {1.0, 1, true, 0.46, 0.0105}, {1.0, 2, true, 0.75, 0.0045},
                           {1.0, 4, true, 1.45, 0.0019}, {1.0, 128, false, 371.0, 0.0006}};
  std::vector<ParetoPoint> points;
  for (const Row& row : kRows) {
    ParetoPoint point;
    point.quality.scale = row.scale;
    point.quality.render.samples = row.samples;
    point.quality.render.bounces = bounces;
    point.quality.render.stored_light = row.stored_light;
    point.cost = row.cpu_us_per_px;
    point.error = row.relmse;
    points.push_back(point);
  }
  return *ParetoFront::make(std::move(points));
}

bool uses_stored_light(const ParetoFront& front) {
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (front[i].quality.render.stored_light) return true;
  }
  return false;
}

}  // namespace cyclorama::governor
