#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the maintenance programs by their exit codes: cyclorama-provision with the checks of display, tracker and
calibrator, cyclorama-health and cyclorama doctor.

Run: care_test.py SOURCE_ROOT BUILD_FOLDER
"""
import contextlib
import json
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from museum_room import room_on  # noqa: E402


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=120)


class Parts:
    """The parts of a museum, which test-parts imitates."""

    def __init__(self, build, *options):
        self.process = subprocess.Popen([build / "bin/test-parts", *options], stdout=subprocess.PIPE, text=True)
        tour, display, tracker, *_ = self.process.stdout.readline().split()
        self.watches = ["--watch", f"tour={tour}", "--watch", f"display={display}", "--watch", f"tracker={tracker}"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(30)


def check_health(build, folder):
    health = build / "bin/cyclorama-health"
    report = folder / "health.json"
    with Parts(build) as parts:
        well = run(health, *parts.watches, "--heads", 3, "--looks", 2, "--deadline", 60, "--report", report)
        assert well.returncode == 0 and json.loads(report.read_text())["well"], well.stderr
        more = run(health, *parts.watches, "--heads", 4, "--deadline", 2)
        assert more.returncode == 1 and "3 heads of 4" in more.stderr, more.stderr
    with Parts(build, "--unwell") as parts:
        dark = run(health, *parts.watches, "--heads", 3, "--deadline", 2, "--report", report)
        assert dark.returncode == 1 and "head 'right' is dark" in dark.stderr, dark.stderr
        assert not json.loads(report.read_text())["well"]
    gone = run(health, *parts.watches, "--deadline", 1)
    assert gone.returncode == 1 and "away" in gone.stderr, gone.stderr


def check_provisioning(source, build, folder):
    """Each settings table is checked by the program that owns it."""
    stick, state = folder / "stick", folder / "state"
    stick.mkdir()
    (stick / "site.toml").write_text('[farm]\ncoordinators = ["[::1]:1"]\nmuseum = "hall-3"\n[display]\nattract_after_s = 5\n')
    (stick / "installation.toml").write_text(room_on(source, "HDMI-A"))
    (stick / "tracker.toml").write_text('[camera]\nkind = "v4l2"\nport = "usb-0000:00:14.0-2"\n')
    (stick / "calibrator.toml").write_text('turntable = "manual"\n[[watch.camera]]\nname = "left"\nkind = "v4l2"\nport = "usb-0000:00:14.0-3"\n')
    (stick / "operator.toml").write_text('pin = "40 17 73"\n')
    provision = [build / "bin/cyclorama-provision", "--state", state]
    changed = folder / "changed"
    install = [*provision, "install", stick, "--programs", build / "bin", "--changed", changed]
    good = run(*install)
    assert good.returncode == 0 and changed.read_text() == "000001\n", good.stderr
    assert "401773" not in "".join(p.read_text() for p in state.rglob("*") if p.is_file())
    changed.unlink()
    assert run(*install).returncode == 0 and not changed.exists(), "the same stick restarts services again"
    for file, text, word in (("site.toml", "[display]\nattract_after = 5\n", "cyclorama-display refuses"),
                             ("tracker.toml", '[camera]\nkind = "v4l3"\n', "cyclorama-tracker refuses"),
                             ("calibrator.toml", '[watch]\ncompare_Hz = 4\n', "cyclorama-calibrator refuses")):
        before = (stick / file).read_text()
        (stick / file).write_text(text)
        bad = run(*install)
        assert bad.returncode == 1 and word in bad.stderr and f"{file}:2" in bad.stderr and "stay in use" in bad.stderr, bad.stderr
        report = json.loads(run(*provision, "status").stdout)
        assert report["verdict"] == "refused" and report["in_use"] == "000001", report
        (stick / file).write_text(before)
    assert not changed.exists()
    (stick / "site.toml").write_text((stick / "site.toml").read_text().replace("hall-3", "hall-4"))
    assert run(*install).returncode == 0
    assert run(*provision, "restore").returncode == 0
    assert "hall-3" in (state / "settings/site.toml").read_text()
    assert run(*provision, "install", folder / "no-stick", "--if-there").returncode == 0
    assert run(*provision, "install", folder / "no-stick").returncode == 1
    assert run(*install).returncode == 0
    return state


def check_calibrator(source, build, folder, state):
    """A calibrator whose fixed camera has no lens calibration starts and reports what is missing."""
    bad_lens = folder / "bad"
    shutil.copytree(state / "settings", bad_lens)
    (bad_lens / "cameras").mkdir()
    (bad_lens / "cameras/left.json").write_text("{}")
    calibrator = [build / "bin/cyclorama-calibrator", "--folder", folder / "calibration",
                  "--listen", f"unix:{folder}/calibrator.sock"]
    refused = run(*calibrator, "--check", "--installation", bad_lens / "installation.toml")
    assert refused.returncode == 1 and "left.json" in refused.stderr and "camera 'left'" in refused.stderr, refused.stderr
    elsewhere = run(*calibrator, "--check", "--installation", state / "settings/installation.toml",
                    "--display", "none-such=[::1]:7404")
    assert elsewhere.returncode == 1 and "belongs to 0 displays" in elsewhere.stderr, elsewhere.stderr
    process = subprocess.Popen([*map(str, calibrator), "--installation", str(state / "settings/installation.toml")],
                               stdin=subprocess.DEVNULL)
    try:
        end = time.monotonic() + 60
        status = ""
        while "cameras/left.json" not in status and process.poll() is None and time.monotonic() < end:
            run(build / "bin/cyclorama", "status", "--json", folder / "status.json",
                "--watch", f"calibrator=unix:{folder}/calibrator.sock")
            status = (folder / "status.json").read_text()
            time.sleep(0.2)
        assert "cameras/left.json" in status, (process.poll(), status)
    finally:
        process.terminate()
    assert process.wait(30) == 0


def check_doctor(build, folder, state):
    doctor = [build / "bin/cyclorama", "doctor", "--museum", state, "--json", folder / "doctor.json"]
    with Parts(build) as parts:
        well = run(*doctor, *parts.watches)
        checks = {check["id"]: check for check in json.loads((folder / "doctor.json").read_text())}
        assert checks["part-tour"]["level"] == checks["heads"]["level"] == checks["settings"]["level"] == "ok", well.stdout
        worst = {check["level"] for check in checks.values()}
        assert well.returncode == (1 if "fault" in worst else 3 if "warning" in worst
                                   else 0), (well.returncode, well.stdout)
    with Parts(build, "--unwell") as parts:
        unwell = run(*doctor, *parts.watches)
        assert unwell.returncode == 1 and "No picture goes to 'right'" in unwell.stdout, unwell.stdout
        assert "-> Switch that projector on" in unwell.stdout, unwell.stdout
        network = run(*doctor, "--network", *parts.watches)
        assert "its program does not run" in network.stdout, network.stdout


def check_hours(build, state):
    """The command line sets, shows and removes an exception from the hours."""
    hours = [build / "bin/cyclorama", "hours", "--museum", state]
    shown = run(*hours)
    assert shown.returncode == 0 and shown.stdout.startswith("Open now.") and "always open" in shown.stdout, shown
    closed = run(*hours, "closed")
    assert closed.returncode == 0 and "Closed now until" in closed.stdout, closed
    assert (state / "hours/override").read_text().startswith("closed from "), closed
    assert "Closed now until" in run(*hours).stdout, "another process does not see it"
    for wrong, words in ((("open",), "say until when"), (("open", "25:00"), "such as 22:00"),
                         (("closed", "22:00"), "with 'open' alone")):
        refused = run(*hours, *wrong)
        assert refused.returncode == 1 and words in refused.stderr, refused
    assert run(*hours, "settings").stdout.startswith("Open now.")
    (state / "hours/override").write_text("open for ever\n")
    broken = run(*hours)
    assert broken.returncode == 0 and "damaged" in broken.stdout, broken


def check_projectors(source, build, folder):
    """Without a projector with a network address cyclorama-projectors runs idle; switching none is an error."""
    site = folder / "hours.toml"
    site.write_text('[farm]\ncoordinators = ["[::1]:7401"]\n')
    projectors = [build / "bin/cyclorama-projectors", "--installation", source / "demo/installation.toml"]
    service = subprocess.Popen([*map(str, projectors), "keep", "--config", site], stderr=subprocess.PIPE, text=True)
    assert "none is switched" in service.stderr.readline()
    assert service.poll() is None
    service.terminate()
    assert service.wait(30) == 0, service.returncode
    on = run(*projectors, "on")
    assert on.returncode != 0 and "no projector is named" in on.stderr, on.stderr


class Projector:
    """A projector that speaks PJLink: it is on and its lamp is worn out."""

    def __init__(self):
        self.listener = socket.create_server(("::1", 0), family=socket.AF_INET6)
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            client, _ = self.listener.accept()
            with client, contextlib.suppress(OSError):  # The client may disconnect.
                client.sendall(b"PJLINK 0\r")
                client.sendall(b"%1ERST=020000\r" if b"ERST" in client.recv(100) else b"%1POWR=1\r")


def check_lamps(source, build, folder):
    """A projector's own report reaches the operator, with a remedy."""
    site, room = folder / "lamps.toml", folder / "installation.toml"
    site.write_text('[farm]\ncoordinators = ["[::1]:7401"]\n')
    text = (source / "demo/installation.toml").read_text()
    room.write_text(text.replace("[[projector]]\n", f'[[projector]]\npjlink = "[::1]:{Projector().port}"\n', 1))
    for mesh in (source / "demo").glob("*.obj"):
        shutil.copy(mesh, folder)
    with socket.create_server(("::1", 0), family=socket.AF_INET6) as free:
        port = free.getsockname()[1]
    service = subprocess.Popen([build / "bin/cyclorama-projectors", "keep", "--config", site, "--installation", room,
                                "--listen",
                               f"[::1]:{port}"], stderr=subprocess.PIPE, text=True)
    try:
        assert "lamp (error)" in service.stderr.readline()
        doctor = run(build / "bin/cyclorama", "doctor", "--museum", folder / "nowhere",
                     "--watch", f"projectors=[::1]:{port}")
        assert doctor.returncode == 1 and "It reports: lamp (error)" in doctor.stdout and "have it replaced" in doctor.stdout, doctor.stdout
    finally:
        service.terminate()
        ended = service.wait(30)
    assert ended == 0, ended


def main(source, build):
    source, build = pathlib.Path(source), pathlib.Path(build)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_health(build, folder)
        state = check_provisioning(source, build, folder)
        check_calibrator(source, build, folder, state)
        check_doctor(build, folder, state)
        check_hours(build, state)
        check_projectors(source, build, folder)
        check_lamps(source, build, folder)
    print("care: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
