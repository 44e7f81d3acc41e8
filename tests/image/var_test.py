#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests how /var is found, sealed, moved over and recovered, on a simulated computer: its programs for disks and the TPM
are stubs that keep their state in files. After each of their calls the power can fail.

Run: var_test.py SOURCE_ROOT
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

KEY = "cbdefghi-jklnrtuv-cbdefghi-jklnrtuv-cbdefghi-jklnrtuv-cbdefghi-jklnrtuv"
EFI = "8be4df61-93ca-11d2-aa0d-00e098032b8c"
SETTINGS = '[farm]\ncoordinators = ["[2001:db8::1]:7401"]\n'
POWER_CUT = 137

# Stubs. $W is the simulated computer: $W/parts/NAME holds a partition's label, $W/parts/NAME.files its files,
# $W/parts/NAME.kind "ext4" or "luks", $W/parts/NAME.seal the policy's key and the firmware that open it.
COMMON = r'''#!/bin/sh
W=%s
step() {
  echo "${0##*/} $*" >>"$W/calls"
  left=$(cat "$W/power" 2>/dev/null) || return 0
  if [ "$left" -eq 0 ]; then kill -9 $(cat "$W/script"); exit 1; fi
  echo $((left - 1)) >"$W/power"
}
last() { for word; do :; done; echo "${word##*/}"; }
opens() { [ "$(cat "$W/parts/$1.seal")" = "$(cat "$W/firmware") $(cat "$W/signs")" ]; }
'''
STUBS = {
    "systemd-analyze": "[ -e $W/root/dev/tpmrm0 ]",
    "udevadm": r'case $1 in settle) exit 0 ;; esac; cat "$W/parts/$(last "$@")" 2>/dev/null',
    "systemd-repart": r'''step "$@"
make() { # NAME LABEL KIND
  rm -rf "$W/parts/$1" "$W/parts/$1."*
  mkdir -p "$W/parts/$1.files" "$W/root/sys/devices/disk/$1"
  : >"$W/root/sys/devices/disk/$1/partition"; : >"$W/root/dev/$1"
  echo "$3" >"$W/parts/$1.kind"
  if [ "$3" = luks ]; then echo "$(cat "$W/firmware") $(cat "$W/root/run/systemd/tpm2-pcr-public-key.pem" | tr -d '\n')" >"$W/parts/$1.seal"; fi
  echo "$2" >"$W/parts/$1"
}
anew=no
case "$*" in *--factory-reset=yes*) anew=yes ;; esac
case "$*" in
  *partitions-open*)
    if [ $anew = yes ] || [ ! -e "$W/parts/open" ]; then make open cyclorama-var-open ext4; fi
    if [ $anew = yes ] || [ ! -e "$W/parts/sealed" ]; then make sealed cyclorama-var none; fi ;;
  *partitions-sealed*)
    case "$*" in *--tpm2-pcrs=7*--tpm2-public-key-pcrs=11*) ;; *) exit 1 ;; esac
    if [ $anew = yes ] || [ ! -e "$W/parts/sealed" ]; then make sealed cyclorama-var luks; fi ;;
esac
step done''',
    "cryptsetup": r'''case $1 in
  isLuks) [ "$(cat "$W/parts/$(last "$@").kind" 2>/dev/null)" = luks ] ;;
  luksDump) printf '{"tokens": {"0": {"tpm2_pubkey":"%s"}}}\n' "$(cut -d ' ' -f 2 "$W/parts/$(last "$@").seal" | base64 -w 0)" ;;
esac''',
    "openssl": "tr -d '\\n'",
    "systemd-cryptsetup": r'''step "$@"
case $1 in
  detach) rm "$W/root/dev/mapper/cyclorama-var"; exit 0 ;;
esac
part=${3##*/}
case $4 in
  none) opens "$part" || exit 1 ;;
  *) [ "$(cat "$4")" = "$(cat "$W/parts/$part.recovery")" ] || exit 1 ;;
esac
echo "$part" >"$W/root/dev/mapper/cyclorama-var"''',
    "systemd-cryptenroll": r'''step "$@"
part=$(last "$@")
case "$*" in
  *--unlock-key-file=*) ;;
  *) opens "$part" || exit 1 ;;
esac
case "$*" in
  *--recovery-key*) echo "%(key)s" >"$W/parts/$part.recovery"; printf '%%s' "%(key)s" >"$W/parts/$part.recovery"; echo "%(key)s" ;;
  *--tpm2-device=auto*) echo "$(cat "$W/firmware") $(tr -d '\n' <"$W/root/run/systemd/tpm2-pcr-public-key.pem")" >"$W/parts/$part.seal" ;;
esac''' % {"key": KEY},
    "blkid": r'''case "$*" in
  *vfat*) if [ -e "$W/stick" ]; then echo stick; fi ;;
  *) cat "$W/parts/$(last "$@").kind" ;;
esac''',
    "fsck.ext4": "exit 0",
    "mount": r'''step "$@"
for word; do device=$at; at=$word; done
part=${device##*/}
case "$*" in
  *tmpfs*) mkdir -p "$W/memory"; rmdir "$at"; ln -s "$W/memory" "$at"; exit 0 ;;
  *vfat*) rmdir "$at"; ln -s "$W/stick" "$at"; exit 0 ;;
esac
if [ "$part" = cyclorama-var ]; then part=$(cat "$device"); fi
[ ! -e "$W/parts/$part.unreadable" ] || exit 1
rmdir "$at" && ln -s "$W/parts/$part.files" "$at"''',
    "umount": r'step "$@"; rm "$1" && mkdir "$1"',
    "mountpoint": '[ -L "$2" ]',
    "blkdiscard": r'''step "$@"; part=$(last "$@"); echo none >"$W/parts/$part.kind"; step halfway; rm -rf "$W/parts/$part.files"; mkdir "$W/parts/$part.files"''',
    "wipefs": r'''step "$@"; part=$(last "$@"); echo none >"$W/parts/$part.kind"; rm -rf "$W/parts/$part.files"; mkdir "$W/parts/$part.files"''',
    "cp": 'step "$@"; /bin/cp "$@"',
    "sync": "step",
    "sleep": "exit 0",
    "chattr": "exit 0",
}


class Computer:
    """A computer whose disk was flashed, and whose state lies in a folder."""

    def __init__(self, source, folder, secure_boot=True, tpm=True):
        self.folder, self.root = folder, folder / "root"
        self.script = source / "image/mkosi.extra/usr/lib/cyclorama/mount-var"
        for name in ("parts", "stubs", "root/dev/mapper", "root/sys/devices/disk/dm-0/slaves", "root/sys/block",
                     "root/sys/firmware/efi/efivars", "root/proc", "root/etc", "root/usr/lib", "root/run/systemd"):
            (folder / name).mkdir(parents=True)
        (self.root / "sys/devices/disk/sda2").mkdir()
        (self.root / "sys/devices/disk/sda2/partition").touch()
        (self.root / "sys/devices/disk/dm-0/slaves/sda2").symlink_to("../../sda2")
        (self.root / "sys/block/dm-0").symlink_to("../devices/disk/dm-0")
        (self.root / "dev/dm-0").touch()
        (self.root / "dev/mapper/root").symlink_to("../dm-0")
        (self.root / "usr/lib/clock-epoch").touch()
        (self.root / "proc/cmdline").write_text("quiet\n")
        self.version("5")
        self.signed_for("museums")
        (folder / "firmware").write_text("firmware-1\n")
        self.tpm(tpm)
        self.secure_boot(secure_boot)
        for name, text in STUBS.items():
            (folder / "stubs" / name).write_text(COMMON % folder + text + "\n")
            (folder / "stubs" / name).chmod(0o755)

    def version(self, number):
        (self.root / "etc/os-release").write_text(f"IMAGE_VERSION={number}\n")

    def signed_for(self, key):
        """The kernel image's measurements are signed with this key, and it brings its public half."""
        (self.folder / "signs").write_text(key + "\n")
        (self.root / "run/systemd/tpm2-pcr-public-key.pem").write_text(key + "\n")

    def tpm(self, is_there):
        device = self.root / "dev/tpmrm0"
        device.touch() if is_there else device.unlink(missing_ok=True)

    def secure_boot(self, is_on, setup=False):
        for name, value in (("SecureBoot", is_on), ("SetupMode", setup)):
            (self.root / f"sys/firmware/efi/efivars/{name}-{EFI}").write_bytes(bytes((6, 0, 0, 0, int(value))))

    def switch_off(self):
        for link in (self.root / "var", self.root / "run/cyclorama"):
            if link.is_symlink():
                link.unlink()
            else:
                shutil.rmtree(link, ignore_errors=True)
        shutil.rmtree(self.folder / "memory", ignore_errors=True)
        (self.root / "dev/mapper/cyclorama-var").unlink(missing_ok=True)

    def start(self, power=None):
        """Starts the computer, whose power fails after so many steps. Returns the exit status."""
        self.switch_off()
        (self.root / "var").mkdir()
        (self.folder / "calls").write_text("")
        (self.folder / "power").unlink(missing_ok=True)
        if power is not None:
            (self.folder / "power").write_text(f"{power}\n")
        command = f'echo $$ >{self.folder}/script; exec sh {self.script}'
        done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False,
                              env={"PATH": f"{self.folder}/stubs:{os.environ['PATH']}", "CYCLORAMA_ROOT": str(self.root)})
        self.output = done.stdout + done.stderr
        return POWER_CUT if done.returncode == -9 else done.returncode

    def state(self):
        file = self.root / "run/cyclorama/var"
        return file.read_text().strip() if file.exists() else ""

    def save(self):
        """Writes settings as cyclorama-provision does."""
        (self.root / "var/lib/cyclorama").mkdir(parents=True, exist_ok=True)
        (self.root / "var/lib/cyclorama/site.toml").write_text(SETTINGS)

    def has_settings(self):
        file = self.root / "var/lib/cyclorama/site.toml"
        return file.exists() and file.read_text() == SETTINGS

    def copy(self, source, folder):
        other = Computer(source, folder)
        shutil.rmtree(folder / "parts")
        shutil.copytree(self.folder / "parts", folder / "parts")
        for part in ("open", "sealed"):
            if (folder / "parts" / part).exists():
                (other.root / f"sys/devices/disk/{part}").mkdir()
                (other.root / f"sys/devices/disk/{part}/partition").touch()
                (other.root / f"dev/{part}").touch()
        return other


class Tests:
    def __init__(self, source, folder):
        self.source, self.folder, self.number, self.bad = source, folder, 0, 0

    def computer(self, **how):
        self.number += 1
        return Computer(self.source, self.folder / str(self.number), **how)

    def copy(self, of):
        self.number += 1
        return of.copy(self.source, self.folder / str(self.number))

    def expect(self, what, is_so, computer=None):
        print(f"{'ok' if is_so else 'FAILED'}: {what}")
        if not is_so:
            self.bad += 1
            if computer:
                print(computer.state(), computer.output, (computer.folder / "calls").read_text(), sep="\n")

    def sealed(self):
        one = self.computer()
        one.start()
        self.expect("with Secure Boot and a TPM, /var is encrypted at once", one.state() == "encrypted", one)
        self.expect("and Secure Boot is told", (one.root / "run/cyclorama/secure-boot").read_text() == "on\n")
        kept = one.root / "var/lib/cyclorama-operator/recovery-key"
        self.expect("a recovery key waits for the page", kept.read_text().strip() == KEY and kept.stat().st_mode & 0o77 == 0)
        one.save()
        one.start()
        self.expect("it opens at the next start", one.state() == "encrypted" and one.has_settings(), one)
        calls = (one.folder / "calls").read_text()
        self.expect("where nothing is made, sealed or wiped", not any(word in calls for word in ("systemd-repart", "cryptenroll", "wipefs", "blkdiscard")), one)
        one.version("6")
        one.start()
        self.expect("a later version opens it without a new seal", one.has_settings() and "enroll" not in (one.folder / "calls").read_text(), one)
        one.signed_for("developers")
        one.start()
        self.expect("a Debug image does not", one.state().startswith("in memory: encrypted") and not one.has_settings(), one)
        one.signed_for("museums")
        one.secure_boot(False)
        (one.folder / "firmware").write_text("no Secure Boot\n")
        one.start()
        self.expect("nor does any without Secure Boot", one.state().startswith("in memory: encrypted") and not one.has_settings(), one)

    def before_secure_boot(self):
        for what, how, reason in (("without Secure Boot", {"secure_boot": False}, "plain: Secure Boot is not on"),
                                  ("without a TPM", {"tpm": False}, "plain: this computer has no TPM, or it is switched off")):
            one = self.computer(**how)
            one.start()
            self.expect(f"{what} /var is not encrypted, and told so", one.state() == reason, one)
            self.expect("and nothing is sealed", not list((one.folder / "parts").glob("*.seal")), one)
            one.save()
            one.start()
            self.expect("its settings stay", one.has_settings() and one.state() == reason, one)
            one.secure_boot(True)
            one.tpm(True)
            self.moved(one)

    def moved(self, before):
        """Moves over without a power cut, then with one after each step."""
        one = self.copy(before)
        one.start()
        self.expect("then they are moved over", one.state() == "encrypted" and one.has_settings(), one)
        self.expect("and the open partition is wiped", list((one.folder / "parts/open.files").iterdir()) == [], one)
        self.expect("with a recovery key", (one.root / "var/lib/cyclorama-operator/recovery-key").exists(), one)
        lost, steps = [], 0
        while True:
            cut = self.copy(before)
            if cut.start(power=steps) != POWER_CUT:
                break
            cut.start()
            left = (cut.folder / "parts/open.files").exists() and list((cut.folder / "parts/open.files").iterdir())
            if not (cut.state() == "encrypted" and cut.has_settings() and not left
                    and (cut.root / "var/lib/cyclorama-operator/recovery-key").exists()):
                lost.append((steps, cut.state(), left))
            steps += 1
        self.expect(f"a power cut after each of {steps} steps loses nothing, and leaves nothing open", steps > 10 and not lost)
        print("".join(f"  {loss}\n" for loss in lost), end="")

    def recovered(self):
        one = self.computer()
        one.start()
        one.save()
        (one.folder / "firmware").write_text("firmware-2\n")
        one.start()
        self.expect("after a firmware update the show goes on", one.state().startswith("in memory: encrypted"), one)
        self.expect("and the remedy is told", "recovery key on a stick" in one.state(), one)
        stick = one.folder / "stick/cyclorama"
        stick.mkdir(parents=True)
        for wrong in ("", "zz\n", "cbdefghi\n", KEY.replace("c", "d")):
            (stick / "recovery-key").write_text(wrong)
            one.start()
            self.expect(f"'{wrong.strip()[:20]}' does not open it", one.state().startswith("in memory: encrypted"), one)
        (stick / "recovery-key").write_text(KEY.upper().replace("-", " ") + "\r\n")
        one.start()
        self.expect("the recovery key brings the settings back, as people type it", one.state() == "encrypted" and one.has_settings(), one)
        self.expect("and is not kept", not (one.root / "run/cyclorama/key").exists())
        shutil.rmtree(one.folder / "stick")
        one.start()
        self.expect("from then on the TPM opens it again", one.state() == "encrypted" and one.has_settings(), one)

    def rotated(self):
        one = self.computer()
        one.start()
        one.save()
        # Signed with the old and the new key; it brings the new one.
        (one.root / "run/systemd/tpm2-pcr-public-key.pem").write_text("museums-2\n")
        one.start()
        self.expect("a version signed with the old and the new key opens it", one.state() == "encrypted" and one.has_settings(), one)
        one.signed_for("museums-2")
        one.start()
        self.expect("it is sealed for the new key from then on", one.state() == "encrypted" and one.has_settings(), one)

    def no_way_back(self):
        one = self.computer()
        oldest = one.root / "sys/firmware/efi/efivars/CycloramaOldest-0ad63fd1-2c52-4be5-9a35-8f5a21b14f4e"
        one.start()
        well = one.root / "var/lib/cyclorama/well-versions"
        one.save()
        well.write_text("5\n")
        one.start()
        self.expect("with one good version, nothing is too old yet", not oldest.exists() and one.has_settings(), one)
        well.write_text("5\n10\n")
        one.version("10")
        one.start()
        self.expect("the version before the newest good one is noted in the firmware", oldest.exists() and oldest.read_bytes() == b"\7\0\0\0" + b"5", one)
        for number, starts in (("5", True), ("4", False), ("4.9", False), ("11", True)):
            one.version(number)
            status = one.start()
            self.expect(f"version {number} {'starts' if starts else 'does not start'}", (status == 0) == starts and one.has_settings() == starts, one)
        one.version("4")
        one.start()
        self.expect("/var is not opened for an old one", "cryptsetup" not in (one.folder / "calls").read_text(), one)
        oldest.unlink()
        self.expect("nor used, when somebody removed the firmware's note", one.start() == 1 and not one.has_settings() and not (one.root / "dev/mapper/cyclorama-var").exists(), one)
        for garbage in (b"", b"\7\0", b"\7\0\0\0", b"\7\0\0\0; reboot\n"):
            oldest.write_bytes(garbage)
            one.version("10")
            self.expect(f"a note that is {garbage} does no harm", one.start() == 0 and one.has_settings() and oldest.read_bytes()[4:] == b"5", one)

    def reset(self):
        for how in ("sealed", "open"):
            one = self.computer(secure_boot=how == "sealed")
            one.start()
            one.save()
            state = one.state()
            (one.root / "var/lib/cyclorama/factory-reset").touch()
            one.start()
            self.expect(f"a reset by its file forgets all ({how})", one.state() == state and not one.has_settings(), one)
            one.save()
            (one.root / "proc/cmdline").write_text("quiet cyclorama.factory_reset\n")
            one.start()
            self.expect(f"a reset by the boot menu does ({how})", one.state() == state and not one.has_settings(), one)
            one.save()
            one.secure_boot(how == "open")
            one.start()
            self.expect(f"it uses what is possible now ({how})", not one.has_settings() and one.state().startswith("encrypted" if how == "open" else "plain"), one)
        one = self.computer()
        one.start()
        (one.folder / "parts/sealed.unreadable").touch()
        one.start()
        self.expect("a disk that cannot be read is told", one.state() == "in memory: the disk cannot be read", one)

    def first_start(self):
        """A power cut at each step of the first start."""
        bad, steps = [], 0
        while True:
            one = self.computer()
            if one.start(power=steps) != POWER_CUT:
                break
            one.start()
            if one.state() != "encrypted" or not (one.root / "var/lib/cyclorama-operator/recovery-key").exists():
                bad.append((steps, one.state()))
            steps += 1
        self.expect(f"a power cut after each of {steps} steps of the first start does no harm {bad}", steps > 5 and not bad)


def main(source):
    with tempfile.TemporaryDirectory() as folder:
        tests = Tests(pathlib.Path(source).resolve(), pathlib.Path(folder))
        tests.sealed()
        tests.before_secure_boot()
        tests.recovered()
        tests.rotated()
        tests.no_way_back()
        tests.reset()
        tests.first_start()
    print("var: ok" if tests.bad == 0 else f"var: {tests.bad} failed")
    return 1 if tests.bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
