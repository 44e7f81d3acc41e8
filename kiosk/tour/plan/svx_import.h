// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kiosk/tour/plan/tour_plan.h"

namespace cyclorama::tour {

struct SvxImport {
  TourPlan plan;
  std::vector<std::string> left_out;  ///< Sentences on what the document has and the plan has not.
};

/// Reads a tour of a Voyager document (*.svx.json, application/si-dpo-3d.document+json; its schema is
/// source/client/schema in github.com/Smithsonian/dpo-voyager). Each step of the tour becomes a stop at its snapshot's
/// camera, and so does each annotation that has a snapshot as its view; titles and leads become titles and texts.
///
/// A snapshot's camera turns about the document's origin: it is Ry(yaw) Rx(pitch) offset, and looks along its -z. Its
/// height, pitch and roll have no place in a tour on foot. The document's frame must be the scene's.
///
/// `tour` counts the document's tours from 0. `name` stands for the file in errors. Errors: kBadData, with the place in
/// the document; kNotFound if it has no such tour, or the tour no step with a camera.
Result<SvxImport> import_svx(std::string_view text, const std::string& name, std::size_t tour = 0);

}  // namespace cyclorama::tour
