#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails on a service that systemd rates as exposed, or that has a line of the shared sandbox of its own. Run: check_units.py"""
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from installed_units import ROOT, exposure, install_units  # noqa: E402

MAX_EXPOSURE = 2.0


def main():
    if not shutil.which("systemd-analyze"):
        print("units: skipped, systemd-analyze is not installed; scripts/install-packages test installs it")
        return 77
    bad = []
    shared = {line.split("=")[0] for line in (ROOT / "systemd/hardening.conf").read_text().splitlines() if "=" in line
              and line[0] != "#"}
    with tempfile.TemporaryDirectory() as root:
        for service in install_units(root):
            if (rated := exposure(root, service)) > MAX_EXPOSURE:
                bad.append(f"{service}: exposed {rated}, at most {MAX_EXPOSURE}")
            unit = ROOT / "systemd/units" / service
            for number, line in enumerate(unit.read_text().splitlines(), 1):
                if line.split("=")[0] in shared:
                    bad.append(f"{unit}:{number}: {line} has no effect here, since hardening.conf is read later; see 20-exceptions.conf")
    print("\n".join(bad) or "units: ok")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
