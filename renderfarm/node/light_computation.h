// SPDX-License-Identifier: Apache-2.0
/// A node's interface to the computation of a scene's light. Production code starts a process (light_process.h); tests
/// script the outcome.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "common/base/result.h"

namespace cyclorama::node {

/// One computation, which ends by itself. pause() and resume() are thread-safe; all else is thread-bound. The
/// destructor aborts an unfinished computation.
class LightComputation {
 public:
  virtual ~LightComputation() = default;
  /// Returns at once. The computation takes no processor time until resume().
  virtual void pause() = 0;
  virtual void resume() = 0;
  /// Returns the completed share, in [0, 1].
  [[nodiscard]] virtual double done_share() = 0;
  /// Returns nothing while the computation runs. Returns success once the file is complete; on failure, an error of one
  /// sentence.
  [[nodiscard]] virtual std::optional<Status> result() = 0;

 protected:
  LightComputation() = default;
  LightComputation(const LightComputation&) = default;
  LightComputation& operator=(const LightComputation&) = default;
};

/// Starts to compute the light of the scene at a path into a file. Errors: one sentence.
using LightStarter = std::function<Result<std::unique_ptr<LightComputation>>(const std::filesystem::path& scene,
                                                                             const std::filesystem::path& file)>;

}  // namespace cyclorama::node
