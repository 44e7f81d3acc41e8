#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the packages on a Debian that boots: installs them under a real systemd, sets them up as install.md describes,
kills, hangs, stops and removes them. It needs root, mmdebstrap, systemd-nspawn (package systemd-container) and some
minutes: ctest runs it only with CYCLORAMA_IMAGE_TESTS=1.

Run: CYCLORAMA_IMAGE_TESTS=1 hosts_test.py SOURCE_ROOT BUILD_FOLDER [ROOT], where ROOT is a folder that keeps the
Debian.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

CHECK = """[Unit]
After=multi-user.target
SuccessAction=poweroff-force
FailureAction=poweroff-force
[Service]
Type=oneshot
ExecStart=/bin/bash /hosts_check.sh
StandardOutput=file:/checked.log
StandardError=inherit
TimeoutStartSec=300
[Install]
WantedBy=default.target
"""
PACKAGES = "systemd systemd-sysv dbus init-system-helpers"


def run(*command, **options):
    subprocess.run([str(part) for part in command], check=True, **options)


def make_root(source, build, folder, root):
    """Makes a bare Debian with the packages' dependencies, without the packages."""
    debs = folder / "debs"
    for component in ("farm", "node"):
        run("cpack", "--config", build / "CPackConfig.cmake", "-G", "DEB", "-B", debs, "-D",
            f"CPACK_COMPONENTS_ALL={component}",
            "-D", "CPACK_DEBIAN_DEBUGINFO_PACKAGE=OFF", cwd=folder, stdout=subprocess.DEVNULL)
    environment = {**os.environ, "KEEP": str(root)}
    run(source / "scripts/in-debian", "bookworm", "true", env=environment)
    shutil.rmtree(root / "debs", ignore_errors=True)
    (root / "debs").mkdir()
    for deb in debs.glob("*.deb"):
        shutil.copy(deb, root / "debs")
    run(source / "scripts/in-debian", "bookworm", "bash", "-c",
        f"apt-get update -qq && apt-get install -y -qq --no-install-recommends {PACKAGES} /debs/*.deb"
        " && dpkg -P cyclorama-farm cyclorama-node", env=environment, stdout=subprocess.DEVNULL)


def boot(source, root):
    shutil.copy(source / "tests/image/hosts_check.sh", root)
    (root / "etc/systemd/system/hosts-check.service").write_text(CHECK)
    wants = root / "etc/systemd/system/multi-user.target.wants/hosts-check.service"
    wants.unlink(missing_ok=True)
    wants.parent.mkdir(exist_ok=True)
    wants.symlink_to("/etc/systemd/system/hosts-check.service")
    log = root / "checked.log"
    log.unlink(missing_ok=True)
    # Runs in a mount namespace with the unified cgroup hierarchy, whatever this machine has.
    command = "mountpoint -q /sys/fs/cgroup && [ $(stat -fc %T /sys/fs/cgroup) = cgroup2fs ] || mount -t cgroup2 none /sys/fs/cgroup; " \
        f"exec systemd-nspawn --quiet --register=no --keep-unit --private-network --link-journal=no --machine=hosts-test --boot -D '{root}'"
    subprocess.run(["unshare", "--mount", "bash", "-c", command], timeout=400, stdin=subprocess.DEVNULL,
                   stdout=subprocess.DEVNULL, env={**os.environ, "SYSTEMD_NSPAWN_UNIFIED_HIERARCHY": "1"})
    return log.read_text() if log.exists() else ""


def main(source, build, kept=None):
    if os.environ.get("CYCLORAMA_IMAGE_TESTS") != "1":
        print("hosts: skipped, takes minutes; CYCLORAMA_IMAGE_TESTS=1 runs it")
        return 77
    missing = [program for program in ("mmdebstrap", "systemd-nspawn") if not shutil.which(program)]
    if missing or os.geteuid() != 0:
        print(f"hosts: skipped, needs root and {' '.join(missing) or 'no more'}")
        return 77
    with tempfile.TemporaryDirectory(dir="/var/tmp") as folder:
        root = pathlib.Path(kept or folder) / "root"
        root.mkdir(parents=True, exist_ok=True)
        make_root(pathlib.Path(source), pathlib.Path(build), pathlib.Path(folder), root)
        checked = boot(pathlib.Path(source), root)
    print(checked)
    fine = checked.endswith("checked\n") and "FAILED" not in checked
    print("hosts: ok" if fine else "hosts: failed")
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
