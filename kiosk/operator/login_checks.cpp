// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/login_checks.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "kiosk/operator/redaction.h"

namespace cyclorama::operations {

bool has_pin(const MuseumState& museum) {
  std::error_code ignored;
  return std::filesystem::status(museum.pin_file(), ignored).type() != std::filesystem::file_type::not_found;
}

std::vector<Check> login_checks(Findings findings) {
  findings.processes.clear();
  findings.is_museum = true;  // A computer that requires a PIN is a museum, even before it has a state folder.
  std::vector<Check> told = checks_of(findings);
  std::erase_if(told, [](const Check& check) {
    return check.id != "settings" && check.id != "stick" && !(check.id == "disk" && check.level == CheckLevel::kFault);
  });
  if (findings.provisioning && !findings.provisioning->in_use.empty()) {
    told.push_back({"pin", "PIN", CheckLevel::kFault, "The settings in use have no PIN, so nobody can enter.",
                    "Scan the code on the wall to choose one, or put a file operator.toml with a line such as pin = "
                    "\"40 17 73\", but with digits of your own, into "
                    "the stick's folder 'cyclorama', and plug it in again."});
  }
  // Removes secrets that people wrote by mistake where a sentence quotes them.
  const Redaction redaction;
  for (Check& check : told) {
    check.sentence = redaction.cleaned(check.sentence);
    while (check.sentence.ends_with('\n')) check.sentence.pop_back();
  }
  return told;
}

std::vector<Check> login_page_checks(const MuseumState& museum) {
  return has_pin(museum) ? std::vector<Check>{} : login_checks(findings_of({}, museum));
}

}  // namespace cyclorama::operations
