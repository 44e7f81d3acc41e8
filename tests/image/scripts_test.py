#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the appliance's scripts that process foreign data: at a start, settings are taken as a whole or refused with a
reason; an update that is damaged or lacks our signature is refused. provision_test checks the settings themselves.

Run: scripts_test.py SOURCE_ROOT BUILD_FOLDER
"""
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from museum_room import room_on  # noqa: E402

GOOD = '[farm]\ncoordinators = ["[2001:db8::1]:7401"]\nmuseum = "Hall 3"\n'
DEFAULT = '[farm]\ncoordinators = ["[::1]:7401"]\n'


class Computer:
    """A computer with an image's files, merged as image/build does."""

    def __init__(self, source, build, folder, profile="museum"):
        folder.mkdir(exist_ok=True)
        self.source = source
        over = folder / "over"
        for tree in (source / "image/mkosi.extra", source / "kiosk/lockdown", source / f"image/mkosi.profiles/{profile}/mkosi.extra"):
            shutil.copytree(tree, over, symlinks=True, dirs_exist_ok=True)
        self.over = over
        self.source = source
        self.scripts = over / "usr/lib/cyclorama"
        self.state = folder / "state"
        self.defaults = over / "usr/share/cyclorama/settings"
        self.state.mkdir()
        if profile == "museum":
            shutil.copy(source / "demo/installation.toml", self.defaults)
        # Stubs, so that no service restarts.
        stubs = folder / "stubs"
        stubs.mkdir()
        for name in ("systemctl", "chown", "cyclorama-fetch-update"):
            (stubs / name).write_text("#!/bin/sh\nexit 0\n")
            (stubs / name).chmod(0o755)
        self.environment = {"PATH": f"{stubs}:{build}/bin:{os.environ['PATH']}", "CYCLORAMA_STATE": str(self.state), "CYCLORAMA_DEFAULTS": str(self.defaults), "CYCLORAMA_PROGRAMS": f"{build}/bin", "CYCLORAMA_ESPS": str(folder / "esp"), "CYCLORAMA_RUN": str(folder / "run"),
                            "CYCLORAMA_UPDATE_KEY": str(folder / "update.pub"), "CYCLORAMA_OS_RELEASE": str(folder / "os-release")}

    def run(self, script, *arguments, **environment):
        return subprocess.run(["sh", str(self.scripts / script), *map(str, arguments)], env=self.environment | environment, capture_output=True, text=True).returncode

    def unit(self, name):
        """Returns the text of one of our units and its drop-ins."""
        files = [self.over / "usr/lib/systemd/system" / name, *sorted((self.over / f"usr/lib/systemd/system/{name}.d").glob("*.conf"))]
        return "".join(file.read_text() for file in files if file.exists())

    def stub(self, name, script):
        file = pathlib.Path(self.environment["PATH"].split(":")[0]) / name
        file.write_text(f"#!/bin/sh\n{script}\n")
        file.chmod(0o755)

    def start_with(self, folder, **environment):
        """Runs a start with the folder's files as systemd credentials."""
        with tempfile.TemporaryDirectory() as credentials:
            for file in folder.iterdir():
                shutil.copy(file, f"{credentials}/cyclorama.{file.name}")
            self.run("find-settings", CREDENTIALS_DIRECTORY=credentials, **environment)

    def report(self, name="provisioning"):
        """Returns the report, which must be JSON, as one text."""
        file = self.state / f"{name}.json"
        return json.dumps(json.loads(file.read_text())) if file.exists() else ""

    def site(self):
        return (self.state / "settings/site.toml").read_text()


def expect(what, is_so, found=""):
    print(f"{'ok' if is_so else 'FAILED'}: {what} {'' if is_so else found}")
    return 0 if is_so else 1


def check_settings(computer, folder):
    bad = 0
    computer.run("find-settings")
    bad += expect("a new computer has the image's settings", '"[::1]:7401"' in computer.site(), computer.report())
    given = folder / "given"
    given.mkdir()
    (given / "site.toml").write_text(GOOD)
    (given / "installation.toml").write_text(room_on(computer.source, "HDMI-A"))
    computer.start_with(given)
    bad += expect("good settings are taken", computer.site() == GOOD and "installed" in computer.report(), computer.report())
    computer.run("find-settings")
    bad += expect("they stay at the next start", computer.site() == GOOD, computer.report())
    for name, file, text, word in (("a wrong key", "site.toml", '[farm]\nheds = ["a"]\n', "heds"), ("no TOML", "site.toml", "\0\1\2", "site.toml"),
                                   ("a wrong wall", "installation.toml", "[wall]\nshape = 'torus'\n", "installation.toml"),
                                   ("a wrong camera", "tracker.toml", "[camera]\nkind = 'film'\n", "film"),
                                   ("a wrong turntable", "calibrator.toml", "turntable = 'lazy-susan'\n", "lazy-susan")):
        wrong = folder / "wrong"
        shutil.copytree(given, wrong)
        (wrong / file).write_text(text)
        computer.start_with(wrong)
        bad += expect(f"{name} is refused with a reason", "refused" in computer.report() and word in computer.report(), computer.report())
        bad += expect(f"{name} changes nothing", computer.site() == GOOD)
        shutil.rmtree(wrong)
    with open(given / "wall.obj", "wb") as file:
        file.truncate(65 << 20)
    computer.start_with(given)
    bad += expect("a file that is too large is refused", "refused" in computer.report() and "wall.obj" in computer.report(), computer.report())
    # Simulates a power cut while others were being written.
    (computer.state / "staging").mkdir(exist_ok=True)
    (computer.state / "staging/site.toml").write_text("half a fi")
    computer.run("find-settings")
    bad += expect("a power cut while settings are written loses none", computer.site() == GOOD)
    (given / "wall.obj").unlink()
    stick, newer = folder / "stick", GOOD + "# newer\n"
    shutil.copytree(given, stick)
    (stick / "site.toml").write_text(newer)
    subprocess.run(["cyclorama-provision", "--state", str(computer.state), "install", str(stick), "--programs", ""], env=computer.environment, capture_output=True, check=True)
    computer.start_with(given)
    bad += expect("later settings from a stick stay", computer.site() == newer, computer.report())
    (given / "site.toml").write_text(GOOD + "# newest\n")
    computer.start_with(given)
    bad += expect("changed credentials are taken", computer.site() == GOOD + "# newest\n", computer.report())
    return bad + check_refused(computer, folder, given, stick)


def check_name(computer, folder):
    """The computer's name, under which mDNS finds it, comes from the museum's."""
    bad = 0
    settings, name = folder / "named", folder / "name"
    settings.mkdir()
    for museum, wanted in (("Hall 3", "hall-3"), ("--Höhle--", "h-hle"), ("", "cyclorama"), ("x" * 80, "x" * 63), ("洞", "cyclorama")):
        (settings / "site.toml").write_text(f'[hours]\nmuseum = "no"\n[farm]\nmuseum = "{museum}"  # yes\n[display]\nmuseum = "no"\n')
        computer.run("set-name", CYCLORAMA_SETTINGS=str(settings), CYCLORAMA_NAME_FILE=str(name))
        bad += expect(f"the museum '{museum}' is {wanted}", name.read_text() == wanted, name.read_text())
    computer.run("set-name", CYCLORAMA_SETTINGS="/nowhere", CYCLORAMA_NAME_FILE=str(name))
    bad += expect("without settings it is cyclorama", name.read_text() == "cyclorama")
    network, resolved = computer.over / "usr/lib/systemd/network", computer.over / "usr/lib/systemd/resolved.conf.d"
    bad += expect("mDNS is on, and LLMNR off", "MulticastDNS=yes" in (network / "80-cable.network.d/mdns.conf").read_text()
                  and "MulticastDNS=yes" in sorted(resolved.glob("*.conf"))[-1].read_text()
                  and "LLMNR=no" in (network / "80-cable.network").read_text() and "LLMNR=no" in (resolved / "cyclorama.conf").read_text())
    bad += expect("the packet filter lets it through", "ff02::fb udp dport 5353" in (computer.over / "etc/nftables.conf").read_text())
    return bad


def check_refused(computer, folder, given, stick):
    """Credentials and files on the boot partition exist again at the next start."""
    bad = 0
    busy = folder / "busy"
    busy.mkdir()
    (busy / "cyclorama-display").write_text("#!/bin/sh\necho not by this clock\nexit 1\n")
    (busy / "cyclorama-display").chmod(0o755)
    for others, taken in ((GOOD + "# late\n", True), (GOOD + "# too late\n", False)):
        (given / "site.toml").write_text(others)
        computer.start_with(given, CYCLORAMA_PROGRAMS=str(busy))
        bad += expect("settings that cannot be used yet are refused", "refused" in computer.report() and computer.site() != others, computer.report())
        if not taken:
            subprocess.run(["cyclorama-provision", "--state", str(computer.state), "install", str(stick), "--programs", ""], env=computer.environment, capture_output=True, check=True)
        computer.start_with(given)
        what = "checked again at the next start" if taken else "not checked again after a stick brought others, which stay with their report"
        bad += expect(f"those are {what}", (computer.site() == others) == taken and "installed" in computer.report(), computer.report())
    return bad


def sign(folder, key):
    sums = subprocess.run("sha256sum *.efi", shell=True, cwd=folder, check=True, capture_output=True).stdout
    (folder / "SHA256SUMS").write_bytes(sums)
    subprocess.run(["openssl", "dgst", "-sha256", "-sign", str(key), "-out", "SHA256SUMS.sig", "SHA256SUMS"], cwd=folder, check=True)


def check_update(computer, folder):
    bad = 0
    for name in ("ours", "theirs"):
        subprocess.run(["openssl", "genpkey", "-quiet", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256", "-out", str(folder / name)], stderr=subprocess.DEVNULL, check=False)
        if not (folder / name).exists():  # OpenSSL 3.0 knows no -quiet.
            subprocess.run(["openssl", "genpkey", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256", "-out", str(folder / name)], stderr=subprocess.DEVNULL, check=True)
    subprocess.run(["openssl", "pkey", "-in", str(folder / "ours"), "-pubout", "-out", str(folder / "update.pub")], check=True)
    (folder / "os-release").write_text("IMAGE_ID=cyclorama-museum\nIMAGE_VERSION=1\n")
    update = folder / "update"
    update.mkdir()
    (update / "cyclorama-museum_2.efi").write_bytes(b"kernel")

    def refused(what, word):
        status = computer.run("update", update)
        return expect(f"{what} is refused", status == 1 and word in computer.report("update"), computer.report("update"))
    bad += refused("an update without a manifest", "signature")
    sign(update, folder / "theirs")
    bad += refused("an update signed with another key", "signature")
    sign(update, folder / "ours")
    (update / "cyclorama-museum_9.efi").write_bytes(b"another's")
    bad += refused("a file beside the signed ones", "cyclorama-museum_9.efi is there, but")
    sign(update, folder / "ours")
    bad += refused("an update of two versions", "more than one version")
    (update / "cyclorama-museum_9.efi").unlink()
    sign(update, folder / "ours")
    (update / "cyclorama-museum_2.efi").write_bytes(b"kernal")
    bad += refused("an update that is damaged", "damaged")
    # While keys are changed, computers trust the old and the new one.
    both = subprocess.run(["openssl", "pkey", "-in", str(folder / "theirs"), "-pubout"], check=True, capture_output=True).stdout
    (folder / "update.pub").write_bytes(both + (folder / "update.pub").read_bytes())
    bad += expect("an update signed with the second of two keys is checked further", computer.run("update", update) == 1 and "damaged" in computer.report("update"), computer.report("update"))
    # The boot loader counts attempts in the name.
    kernels = folder / "esp/EFI/Linux"
    kernels.mkdir(parents=True)
    went_back = {"CYCLORAMA_ESP": str(folder / "esp")}
    (kernels / "cyclorama-museum_1.efi").write_text("")
    (kernels / "cyclorama-museum_2+1-2.efi").write_text("")
    computer.run("update", "--went-back", **went_back)
    bad += expect("a version with attempts left is not reported", "rolled-back" not in computer.report("update"), computer.report("update"))
    (kernels / "cyclorama-museum_2+1-2.efi").rename(kernels / "cyclorama-museum_2+0-3.efi")
    computer.run("update", "--went-back", **went_back)
    bad += expect("a version that was rolled back is reported", "rolled-back" in computer.report("update") and "2 did not start well; 1 runs again" in computer.report("update"),
                  computer.report("update"))
    (update / "cyclorama-museum_2.efi").rename(update / "cyclorama-museum-debug_2.efi")
    sign(update, folder / "ours")
    bad += refused("an update for another image", "it contains nothing for")
    return bad


def check_written(computer, folder):
    """Records of versions keep the farm from sending one again."""
    bad = 0
    update, sysupdate = folder / "written", folder / "sysupdate"
    seen = computer.state / "update-seen"

    def bring(version, writes, is_newer=True):
        shutil.rmtree(update, ignore_errors=True)
        update.mkdir()
        (update / f"cyclorama-museum_{version}.efi").write_bytes(b"kernel")
        sign(update, folder / "ours")
        sysupdate.write_text(f'#!/bin/sh\nfor verb; do case $verb in check-new) {f"echo {version}" if is_newer else "exit 1"} ;; update) {writes} ;; esac; done\n')
        sysupdate.chmod(0o755)
        (computer.state / "update.json").unlink(missing_ok=True)
        return computer.run("update", update, CYCLORAMA_SYSUPDATE=str(sysupdate)), computer.report("update"), seen.read_text().strip() if seen.exists() else None
    (folder / "os-release").write_text("IMAGE_ID=cyclorama-museum\nIMAGE_VERSION=1\n")
    cut = bring("3", "kill -9 $PPID")
    bad += expect("after a power cut a version can be fetched again", cut[0] != 0 and cut[2] is None, str(cut))
    written = bring("3", "exit 0")
    bad += expect("a written version is not fetched again", written[0] == 0 and '"ready"' in written[1] and written[2] == "3", str(written))
    older = bring("2", "exit 0", is_newer=False)
    bad += expect("an older version from a stick does not change that", '"current"' in older[1] and older[2] == "3", str(older))
    failed = bring("10", "exit 1")
    bad += expect("a version that cannot be written is reported and not fetched again", '"failed"' in failed[1] and failed[2] == "10", str(failed))
    return bad


def check_requests(computer, folder):
    """The operator page may request three actions of root, by a file's name."""
    bad = 0
    requests = folder / "requests"
    requests.mkdir()
    called = folder / "called"
    (folder / "stubs/systemctl").write_text(f'#!/bin/sh\necho "$@" >>{called}\n')
    blocks, confirmed = folder / "blocks", folder / "confirmed"
    where = {"CYCLORAMA_REQUESTS": str(requests), "CYCLORAMA_BLOCKS": str(blocks), "CYCLORAMA_CONFIRMED": str(confirmed)}
    blocks.mkdir()
    for name, bus, kind, label in (("sda1", "ata", "vfat", "ESP"), ("sdy1", "usb", "vfat", "HOLIDAY"), ("sdz1", "usb", "vfat", "CYCLORAMA"), ("sdx1", "usb", "ext4", "CYCLORAMA")):
        (blocks / name).write_text(f"ID_BUS={bus}\nID_FS_TYPE={kind}\nID_FS_LABEL={label}\n")
    computer.stub("udevadm", 'for word; do case $word in --path=*) cat "${word#--path=}" ;; esac; done')

    def request(name, content="\n"):
        called.write_text("")
        (requests / name).write_text(content)
        return computer.run("request", name, **where)
    bad += expect("a requested update checks the stick", request("update") == 0 and "cyclorama-update@sdz1.service" in called.read_text(), called.read_text())
    bad += expect("a requested reset restarts the computer", request("factory-reset") == 0 and called.read_text() == "reboot\n", called.read_text())
    bad += expect("and leaves a file for cyclorama-var", (computer.state / "factory-reset").exists())
    bad += expect("another request is refused", request("poweroff") == 1 and called.read_text() == "", called.read_text())
    bad += expect("a request is carried out once", list(requests.iterdir()) == [])
    digest = "0123456789abcdef" * 4
    bad += expect("a confirmed stick is read again", request("confirm-stick", digest + "\n") == 0 and called.read_text().split() == ["start", "--no-block", "cyclorama-provision@sdy1.service", "start", "--no-block", "cyclorama-provision@sdz1.service"], called.read_text())
    bad += expect("with its digest", (confirmed / "confirmed").read_text() == digest + "\n")
    for wrong in ("", "../../etc\n", digest[1:] + "\n", digest[:-1] + "G\n"):
        bad += expect(f"'{wrong.strip()[:10]}' confirms nothing", request("confirm-stick", wrong) == 1 and called.read_text() == "" and (confirmed / "confirmed").read_text() == digest + "\n")
    unit = (computer.source / "systemd/units/cyclorama-provision@.service").read_text()
    rules = ("--stick", "--checker cyclorama-check-settings.service", "--confirmed /run/cyclorama-provision/confirmed")
    bad += expect("sticks are taken by these rules", all(rule in unit for rule in rules))
    (blocks / "sdz1").unlink()
    bad += expect("without a stick the farm is checked", request("update") == 0 and "cyclorama-update-from-farm@now.service" in called.read_text(), called.read_text())
    return bad


def check_farm_updates(computer, folder):
    """The result of cyclorama-fetch-update becomes the page's report and, at night, a restart."""
    bad = 0
    updates, called = folder / "updates", folder / "called"
    (folder / "os-release").write_text("IMAGE_ID=cyclorama-museum\nIMAGE_VERSION=1\n")

    def look(when, result, sysupdate="exit 1"):
        called.write_text("")
        shutil.rmtree(updates, ignore_errors=True)
        (updates / "offer").mkdir(parents=True)
        (updates / "offer/SHA256SUMS").write_text("")
        report = f"printf '%s\\n' '{result}' >{updates}/result" if result else "true"
        computer.stub("systemctl", f'echo "$@" >>{called}; if [ "$1" = start ]; then {report}; fi')
        computer.run("update-from-farm", when, CYCLORAMA_UPDATES=str(updates))
        return computer.report("update")
    (computer.state / "update.json").unlink(missing_ok=True)
    report = look("night", "later it is not the time for updates")
    bad += expect("the certificate is renewed first", called.read_text().splitlines()[:2] == ["start cyclorama-renew-certificate.service", "start cyclorama-take-certificate.service"], called.read_text())
    bad += expect("by day nothing is reported", report == "" and "cyclorama-fetch-update@night.service" in called.read_text(), report + called.read_text())
    report = look("now", "nothing nothing newer than 1")
    bad += expect("that nothing is newer is reported", '"current"' in report and "nothing newer than 1" in report, report)
    bad += expect("and the files of an older one are removed", not (updates / "offer").exists())
    report = look("now", "failed the disk has \"room\"\\ for 3 MB")
    bad += expect("the reason is reported", '"failed"' in report and "the disk has room for 3 MB" in report, report)
    report = look("night", "")
    bad += expect("a program that ends without a result is reported", '"failed"' in report and "checks the farm failed" in report, report)
    report = look("night", "ready 2 has come from the farm")
    bad += expect("fetched files are checked like a stick's, and removed", "does not bear our signature" in report and not (updates / "offer").exists(), report)
    ready = '{"state": "ready", "version": "1", "available": "2", "at": "", "sentence": "2 is there"}'
    for when, result, starts in (("now", "nothing x", False), ("night", "later x", False), ("day", "nothing x", False), ("day", "", False), ("night", "nothing x", True), ("night", "nothing x", False)):
        # The night may end, and the museum open, during fetching and writing.
        computer.stub("cyclorama-fetch-update", "exit 1" if when == "day" else "exit 0")
        when = "night" if when == "day" else when
        (computer.state / "update.json").write_text(ready)
        report = look(when, result)
        bad += expect(f"{when}, {result or 'no result'}: {'restarts, once' if starts else 'does not restart'}", ("reboot" in called.read_text()) == starts and '"ready"' in report, called.read_text() + report)
    (computer.state / "update.json").write_text(ready)
    (computer.state / "started-for").unlink()
    computer.stub("cyclorama-health", f'echo "health $@" >>{called}')
    look("night", "nothing x")
    report = called.read_text()
    bad += expect("dark heads are recorded before the restart", f"--note-dark {computer.state}/dark-heads" in report and report.index("health") < report.index("reboot"), report)
    (computer.state / "update.json").write_text(ready)
    (folder / "os-release").write_text("IMAGE_ID=cyclorama-museum\nIMAGE_VERSION=2\n")
    computer.run("update", "--went-back", CYCLORAMA_ESP=str(folder / "no-esp"))
    bad += expect("a running version is not ready any more", '"current"' in computer.report("update") and '"version": "2"' in computer.report("update"), computer.report("update"))
    (computer.state / "update.json").write_text('{"state": "rolled-back", "version": "1", "available": "2", "at": "", "sentence": "2 did not start well; 1 runs again"}')
    bad += expect("a version that was rolled back stays reported", "rolled-back" in look("night", "nothing 2 was here already"), computer.report("update"))
    return bad


def free_port():
    with socket.socket(socket.AF_INET6) as probe:
        probe.bind(("::1", 0))
        return probe.getsockname()[1]


def check_fetch_program(build, folder):
    """Tests a farm that offers a version and the museum's program that fetches it, with certificates."""
    bad = 0
    here = folder / "fetch"
    store = here / "store/cyclorama-museum"
    store.mkdir(parents=True)
    for name in ("cyclorama-museum_2.efi", "cyclorama-museum_2_0b.root.raw", "cyclorama-museum_2_0c.verity.raw"):
        (store / name).write_bytes(name.encode() * 1000)
    sums = subprocess.run("sha256sum cyclorama-*", shell=True, cwd=store, check=True, capture_output=True).stdout
    (store / "SHA256SUMS").write_bytes(sums)
    subprocess.run(["openssl", "dgst", "-sha256", "-sign", str(folder / "ours"), "-out", "SHA256SUMS.sig", "SHA256SUMS"], cwd=store, check=True)
    authority = [f"{build}/bin/cyclorama-authority", "--folder", str(here / "authority")]
    subprocess.run([*authority, "init"], check=True, stdout=subprocess.DEVNULL)
    for role, *more in (("coordinator", "farm", "--address", "::1"), ("museum", "hall-3")):
        (here / role).mkdir()
        subprocess.run([*authority, "--output", f"{here}/{role}.tar", role, *more], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["tar", "-xf", f"{here}/{role}.tar", "-C", str(here / role)], check=True)
    port = free_port()
    tls = 'authority = "{0}/authority.crt"\ncertificate = "{0}/certificate.crt"\nkey = "{0}/key.pem"\n'
    (here / "farm.toml").write_text(f'museums = "[::1]:{port}"\nnodes = "[::1]:{free_port()}"\n[[scene]]\nname = "a"\npath = "/srv/a"\n'
                                    f'[updates]\nfolder = "{here}/store"\n[tls]\n' + tls.format("coordinator"))
    (here / "site.toml").write_text(f'[farm]\ncoordinators = ["[::1]:{port}"]\nmuseum = "hall-3"\n' + tls.format("museum") + '[hours]\nopen = ["Mon-Sun 00:00-24:00"]\n')
    (here / "os-release").write_text('NAME=Debian\nIMAGE_ID="cyclorama-museum"\nIMAGE_VERSION=1\n')
    (here / "at").mkdir()

    def fetch(when):
        done = subprocess.run([f"{build}/bin/cyclorama-fetch-update", "--config", here / "site.toml", "--release", here / "os-release", "--key", folder / "update.pub",
                               "--state", here, "--folder", here / "at", "--when", when], capture_output=True, text=True)
        return (here / "at/result").read_text() if done.returncode == 0 else done.stderr
    farm = subprocess.Popen([f"{build}/bin/cyclorama-farm", "--config", here / "farm.toml"], stderr=subprocess.PIPE, text=True)
    try:
        farm.stderr.readline()
        report = fetch("night")
        bad += expect("an open museum fetches nothing", report.startswith("later ") and not (here / "at/offer").exists(), report)
        report = fetch("now")
        bad += expect("a complete version is fetched from the farm", report.startswith("ready 2 ") and all((here / "at/offer" / file.name).read_bytes() == file.read_bytes() for file in store.iterdir()), report)
        (here / "update.json").write_text('{"state": "rolled-back", "version": "1", "available": "2"}')
        report = fetch("now")
        bad += expect("one that was rolled back is not fetched again", report.startswith("nothing 2 "), report)
        (here / "update.json").unlink()
        (store / "SHA256SUMS").write_bytes((b"1" if sums.startswith(b"0") else b"0") + sums[1:])
        report = fetch("now")
        bad += expect("one without this signature is refused", report.startswith("failed ") and "signature" in report, report)
    finally:
        farm.kill()
        farm.wait()
    return bad


def check_health(computer, folder):
    """A version on trial that is not well is rolled back; one that was good before stays, and has three attempts again."""
    bad = 0
    kernels = folder / "boot/EFI/Linux"
    where = {"CYCLORAMA_ESP": str(folder / "boot"), "CYCLORAMA_SETTINGS": str(computer.defaults)}
    good, well_versions = folder / "boot/loader/good-versions", computer.state / "well-versions"

    def start(version, name, well):
        """Starts a version whose kernel image has this name, as the boot loader left it."""
        shutil.rmtree(kernels, ignore_errors=True)
        kernels.mkdir(parents=True)
        (kernels / name).write_text("")
        (folder / "os-release").write_text(f"IMAGE_ID=cyclorama-museum\nIMAGE_VERSION={version}\n")
        computer.stub("cyclorama-health", f'[ "$2" = 3 ] || exit 9; exit {0 if well else 1}')
        status = computer.run("health", **where)
        return status, [kernel.name for kernel in kernels.iterdir()]
    bad += expect("a flashed version that is not well stays", start("1", "cyclorama-museum_1.efi", False) == (0, ["cyclorama-museum_1+3.efi"]))
    bad += expect("it was not well yet", not well_versions.exists())
    bad += expect("its attempts are counted from then on", start("1", "cyclorama-museum_1+2-1.efi", True) == (0, ["cyclorama-museum_1+3.efi"]))
    bad += expect("a version on trial that is not well fails", start("2", "cyclorama-museum_2+2-1.efi", False) == (1, ["cyclorama-museum_2+2-1.efi"]))
    bad += expect("and was not well", well_versions.read_text() == "1\n" and good.read_text() == "1\n")
    bad += expect("one that is well stays", start("2", "cyclorama-museum_2+1-2.efi", True) == (0, ["cyclorama-museum_2+3.efi"]))
    bad += expect("both were well", well_versions.read_text() == "1\n2\n" and good.read_text() == "1\n2\n")
    bad += expect("a good version that is not well stays", start("2", "cyclorama-museum_2+2-1.efi", False) == (0, ["cyclorama-museum_2+3.efi"]))
    bad += expect("as the one before does, after the other has rotted", start("1", "cyclorama-museum_1+2-1.efi", True) == (0, ["cyclorama-museum_1+3.efi"]))
    bad += expect("which changes no order", well_versions.read_text() == "1\n2\n")
    bad += expect("the third makes the first too old", start("10", "cyclorama-museum_10+2-1.efi", True)[0] == 0 and well_versions.read_text() == "2\n10\n" and good.read_text() == "2\n10\n", good.read_text())
    bad += expect("a version is well wherever its kernel image is", start("10", "other.efi", True) == (0, ["other.efi"]))
    return bad


HEAD = 'museums = "[::1]:7401"\nnodes = "[::1]:7402"\n[[scene]]\nname = "cave"\npath = "/etc/cyclorama/cave"\non = "coordinator"\n'


def check_farm_host(host, folder):
    """A render host gets its settings in the same ways; they decide what it is."""
    bad = 0
    host.environment["CYCLORAMA_SETTINGS_FOR"] = "farm-host"
    bad += expect("a render host's units name it", all("CYCLORAMA_SETTINGS_FOR=farm-host" in host.unit(name) for name in ("cyclorama-provision@.service", "cyclorama-find-settings.service")))
    host.run("find-settings")
    bad += expect("a new render host has no settings", not (host.state / "settings").exists(), host.report())
    bad += expect("and its start succeeds", host.run("is-well", CYCLORAMA_SETTINGS=str(host.state / "settings")) == 0)
    esp = folder / "host/esp/cyclorama"
    (esp / "cave").mkdir(parents=True)
    (esp / "cave/scene.toml").write_text("")
    (esp / "farm.toml").write_text(HEAD)
    (esp / "node.toml").write_text('coordinators = ["[::1]:7402"]\n')
    host.run("find-settings")
    settings = host.state / "settings"
    bad += expect("settings and a scene of the boot partition are taken", (settings / "cave/scene.toml").exists() and "installed" in host.report(), host.report())
    (esp / "farm.toml").write_text(HEAD.replace("museums", "musuems"))
    host.run("find-settings")
    bad += expect("the coordinator's reader refuses a wrong key", "refused" in host.report() and "musuems" in host.report(), host.report())
    (esp / "farm.toml").write_text(HEAD)
    (esp / "node.toml").write_text('coordinators = ["[::1]:7402"]\nthreads = 99999\n')
    host.run("find-settings")
    bad += expect("the node's own reader refuses a wrong value", "refused" in host.report() and "threads" in host.report(), host.report())
    bad += expect("and they change nothing", (settings / "farm.toml").read_text() == HEAD)
    console = folder / "console"
    (folder / "recovery-key").write_text("cbdefghi-jklnrtuv\n")
    host.run("tell-settings", CYCLORAMA_CONSOLE=str(console), CYCLORAMA_KEPT=str(folder))
    bad += expect("the serial port shows why", "threads" in console.read_text())
    bad += expect("and the recovery key", "recovery key cbdefghi-jklnrtuv" in console.read_text())
    given = folder / "given-node"
    given.mkdir()
    (given / "node.toml").write_text('coordinators = ["[2001:db8::1]:7402"]\n')
    shutil.rmtree(esp)
    host.start_with(given)
    bad += expect("credentials can make it a node alone", not (settings / "farm.toml").exists() and "2001:db8::1" in (settings / "node.toml").read_text(), host.report())
    fast = {"CYCLORAMA_SETTINGS": str(settings), "CYCLORAMA_HEALTH_S": "1", "CYCLORAMA_STILL_S": "0"}
    calls = folder / "asked"
    calls.write_text("")
    host.stub("systemctl", f'echo "$@" >>{calls}; case $1 in show) echo 0 ;; esac')
    bad += expect("a node that runs is well", host.run("is-well", **fast) == 0)
    bad += expect("and no coordinator is expected", "cyclorama-node" in calls.read_text() and "cyclorama-farm" not in calls.read_text(), calls.read_text())
    host.stub("systemctl", "case $1 in show) echo 0 ;; *) exit 3 ;; esac")
    bad += expect("a node that does not start is not well", host.run("is-well", **fast) == 1)
    host.stub("systemctl", f"case $1 in show) wc -l <{calls}; echo >>{calls} ;; esac")
    bad += expect("nor is one that restarts again and again", host.run("is-well", **fast) == 1)
    rules = (host.over / "etc/nftables.conf").read_text()
    bad += expect("only the ports for museums and nodes are open", "tcp dport { 7401, 7402 }" in rules and "8443" not in rules)
    bad += expect("it has nothing of a museum", not list(host.over.rglob("*request*")) + list(host.over.rglob("cyclorama-display*")))
    return bad


def main(source, build):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        computer = Computer(pathlib.Path(source).resolve(), pathlib.Path(build).resolve(), folder)
        bad = check_settings(computer, folder) + check_update(computer, folder) + check_written(computer, folder) + check_requests(computer, folder) + check_name(computer, folder)
        bad += check_farm_updates(computer, folder) + check_fetch_program(pathlib.Path(build).resolve(), folder) + check_health(computer, folder)
        bad += check_farm_host(Computer(pathlib.Path(source).resolve(), pathlib.Path(build).resolve(), folder / "host", "farm-host"), folder)
    print("scripts: ok" if bad == 0 else f"scripts: {bad} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
