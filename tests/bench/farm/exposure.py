# SPDX-License-Identifier: Apache-2.0
"""Prints systemd's own rating of the services' exposure, from 0 (none) to 10: exposure.py. Nothing is started.

The farm's services may have at most 2.0.
"""
import json
import pathlib
import shutil
import subprocess
import sys

UNITS = pathlib.Path(__file__).resolve().parents[3] / "systemd/units"
MAX_EXPOSURE = 2.0
LIMITED = ("cyclorama-farm", "cyclorama-node")


def exposure(unit):
    report = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager", unit], capture_output=True, text=True, check=False)
    for line in report.stdout.splitlines():
        if "Overall exposure level" in line:
            return float(line.split(":")[1].split()[0])
    sys.exit(f"farm-security: {unit}: {report.stderr.strip()}")


def main():
    if not shutil.which("systemd-analyze"):
        sys.exit("farm-security: systemd-analyze is not installed; scripts/install-packages test installs it")
    scores = {unit.stem: exposure(unit) for unit in sorted(UNITS.glob("*.service"))}
    for name, score in scores.items():
        print(f"{name:<24}{score:4.1f}{'' if score <= MAX_EXPOSURE else '  too much'}")
    print(json.dumps({"benchmark": "farm-security", **scores}))
    return any(scores[name] > MAX_EXPOSURE for name in LIMITED)


if __name__ == "__main__":
    sys.exit(main())
