# SPDX-License-Identifier: Apache-2.0
"""The systemd units as they are installed, with their drop-ins, for systemd's offline tools."""
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]


def install_units(root, image_trees=()):
    """Writes our units below `root`, then those of trees of the image (such as "mkosi.extra"). Returns the services' names."""
    units = pathlib.Path(root) / "usr/lib/systemd/system"
    shutil.copytree(ROOT / "systemd/units", units)
    for service in list(units.glob("*.service")):
        drop_ins = service.with_name(service.name + ".d")
        drop_ins.mkdir(exist_ok=True)
        shutil.copy(ROOT / "systemd/hardening.conf", drop_ins / "10-hardening.conf")
    for tree in image_trees:
        shutil.copytree(ROOT / "image" / tree / "usr/lib/systemd/system", units, symlinks=True, dirs_exist_ok=True)
    return sorted(service.name for service in units.glob("cyclorama-*.service"))


def exposure(root, service):
    """Returns systemd's rating of a service, from 0 (not exposed) to 10. It raises RuntimeError if there is none."""
    report = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager", f"--root={root}", service],
                            capture_output=True, text=True, check=False)
    for line in report.stdout.splitlines():
        if "Overall exposure level" in line:
            return float(line.split(":")[1].split()[0])
    raise RuntimeError(f"{service}: {report.stderr.strip()}")
