// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/coordinator/coordinator.h"

namespace cyclorama {

/// Reads farm.toml:
///
///   museums = "[::]:7401"            # Where museums dial.
///   nodes = "[::]:7402"              # Where nodes dial.
///   inspect = "[::1]:7403"           # Where the operator looks; without it, nowhere.
///   balance = "cost-map-stealing"    # For comparison: "cost-map", "pbt-leaves", "pbt" or "equal".
///   museums_file = "museums.toml"    # Who may see what (renderfarm/trust/grants.h); without it, all museums
///   everything. audit = "/var/log/cyclorama-farm/audit.jsonl"   # Without it, no audit log. insecure = false # true:
///   ports beyond this machine need no TLS.
///   [[scene]]                        # The first is the default.
///   name = "grotto"
///   path = "/srv/scenes/grotto"
///   on = "nodes"                     # Whose disks: "nodes", or "head", which hands the files out.
///   [distribution]                   # Of scenes on the head. Each may be left out.
///   digests = ""                     # A file that spares a head that starts again reading them all; "": none.
///   limit_mbit_per_s = 0             # To all nodes together; 0: none.
///   files = 64                       # On their way at once.
///   [updates]                        # Left out: museums get none from here.
///   folder = "/srv/updates"          # update_shelf.h
///   [tls]                            # Without it the ports must be of this machine alone.
///   authority = "tls/authority.crt"  # Files are sought in farm.toml's folder.
///   certificate = "tls/certificate.crt"
///   key = "tls/key.pem"
///   revoked = "tls/crl.pem"          # Without it, no certificate is revoked.
///   [watch]                          # watch_options.h; left out: nobody watches over HTTP.
///   address = "[::1]:7404"
///   [limits]                         # Each may be left out.
///   nodes = 512
///   visits = 64
///   picture_megapixels = 67
///
/// Errors as Config's, and kInvalidArgument as validate(HeadOptions).
Result<HeadOptions> read_head_config(const std::filesystem::path& path);
/// The same of a text; `name` stands in errors for the file's.
Result<HeadOptions> parse_head_config(std::string_view text, const std::string& name);

/// NAME=PATH, as on the command line. kInvalidArgument.
Result<FarmScene> parse_farm_scene(const std::string& text);

}  // namespace cyclorama
