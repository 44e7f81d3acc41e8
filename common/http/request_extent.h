// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace cyclorama {

/// Length of the first request among received bytes, as far as it is known.
struct RequestExtent {
  std::size_t bytes = 0;  ///< Length of head and body; 0 while the head is incomplete.
  /// The body is longer than allowed. `bytes` is then the head's alone, and whoever handles that must refuse it.
  bool is_body_left_out = false;
  int refusal = 0;  ///< HTTP status of a request that is to be refused; 0: none.
};

/// Finds the end of the first request in `received`: the head's empty line, and the body by Content-Length. Refusals:
/// 431 if the head is longer than `max_head_bytes`, 411 for a chunked body, 400 for a Content-Length that is no number
/// or differs from another. Pure.
[[nodiscard]] RequestExtent request_extent(std::string_view received, std::size_t max_head_bytes,
                                           std::size_t max_body_bytes);

}  // namespace cyclorama
