# SPDX-License-Identifier: Apache-2.0
"""Prints systemd's rating of the services' exposure, from 0 (none) to 10: exposure.py. Nothing is started.

The farm's services may have at most 2.0.
"""
import json
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from installed_units import exposure, install_units  # noqa: E402

MAX_EXPOSURE = 2.0
LIMITED = ("cyclorama-farm", "cyclorama-node")


def main():
    if not shutil.which("systemd-analyze"):
        sys.exit("farm-security: systemd-analyze is not installed; scripts/install-packages test installs it")
    with tempfile.TemporaryDirectory() as root:
        scores = {pathlib.Path(service).stem: exposure(root, service) for service in install_units(root)}
    for name, score in scores.items():
        print(f"{name:<24}{score:4.1f}{'' if score <= MAX_EXPOSURE else '  too much'}")
    print(json.dumps({"benchmark": "farm-security", **scores}))
    return any(scores[name] > MAX_EXPOSURE for name in LIMITED)


if __name__ == "__main__":
    sys.exit(main())
