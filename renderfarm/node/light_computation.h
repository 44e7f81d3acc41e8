// SPDX-License-Identifier: Apache-2.0
/// A node's interface to the computation of a scene's light. Production code starts a process (light_process.h); tests
/// script the outcome.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::node {

/// A stage that has begun. Its files are `<number>-<piece>` in `folder`, those of fetched pieces, too.
struct BegunStage {
  std::uint32_t number = 0;
  std::string key;
  std::uint32_t pieces = 0;
  std::filesystem::path folder;
};
/// A piece whose results the computation has taken.
struct TakenPiece {
  std::uint32_t stage = 0;
  std::uint32_t piece = 0;
  std::string sha256;  ///< Digest of its file.
  std::uint64_t bytes = 0;
};
using LightEvent = std::variant<BegunStage, TakenPiece>;

/// One computation, which ends by itself, but computes pieces only when ordered to. pause(), resume(), compute() and
/// fetched() are thread-safe; the rest is thread-bound. The destructor ends an unfinished one.
class LightComputation {
 public:
  virtual ~LightComputation() = default;
  /// Returns at once. The computation takes no processor time until resume().
  virtual void pause() = 0;
  virtual void resume() = 0;
  /// Orders a piece; without effect if the computation is at another stage.
  virtual void compute(std::uint32_t stage, std::uint32_t piece) = 0;
  /// The file of a piece has been put into the stage's folder.
  virtual void fetched(std::uint32_t stage, std::uint32_t piece) = 0;
  /// Returns what has happened since the last call.
  [[nodiscard]] virtual std::vector<LightEvent> events() = 0;
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
