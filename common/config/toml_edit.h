// SPDX-License-Identifier: Apache-2.0
/// Changes one table or one value in a settings file, and keeps everything else, comments included, as it is.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// Replaces [table] with its sub-tables by `lines`, which begin with its header; appends them if there is no such table;
/// removes it if `lines` is empty. `name` stands for the file in errors. Errors: kBadData if the text is not TOML, or if
/// the table is written in a way that cannot be replaced, such as `table = { ... }`.
Result<std::string> with_table(std::string_view text, std::string_view name, std::string_view table,
                               std::string_view lines);

/// Sets `key` in [table] to a value written in TOML, such as `"grotto"` or `[1, 2]`. Errors: those of with_table().
Result<std::string> with_value(std::string_view text, std::string_view name, std::string_view table,
                               std::string_view key, std::string_view value);

}  // namespace cyclorama
