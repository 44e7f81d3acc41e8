// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/view.pb.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/session_table.h"

namespace cyclorama::coordinator {

/// Decides what museums may request: whether a view and a frame budget are valid and within the museum's grant, and
/// whether its scenes need no more memory than it may use. Changes nothing. Pure; thread-bound; the tables must outlive
/// it.
class SessionAdmission {
 public:
  /// `max_picture_px`: pixels of the largest picture.
  SessionAdmission(std::int64_t max_picture_px, const NodeTable& nodes, const SessionTable& sessions)
      : max_picture_px_(max_picture_px), nodes_(nodes), sessions_(sessions) {}

  /// Errors: kInvalidArgument.
  [[nodiscard]] Status check_view(const Session& session, const wire::View& view) const;
  /// Errors: kBusy if the museum's open scenes and this one need more memory than its grant allows.
  [[nodiscard]] Status check_scene_memory(const Session& session, const std::string& scene) const;
  /// Returns the samples of the session's reference; 0 if it has no frame budget, so that its views set their quality.
  /// Errors: kInvalidArgument.
  [[nodiscard]] static Result<int> reference_samples(const Session& session, const wire::OpenSession& open);

 private:
  const std::int64_t max_picture_px_;
  const NodeTable& nodes_;
  const SessionTable& sessions_;
};

}  // namespace cyclorama::coordinator
