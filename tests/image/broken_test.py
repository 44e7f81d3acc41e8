#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the screen that tells people that no version starts: when it comes, and that it is whole on every screen.

Run: broken_test.py SOURCE_ROOT
"""
import pathlib
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 8, 5
PICTURE = bytes(value % 251 + 1 for value in range(WIDTH * HEIGHT * 4))
STUB = "StubImageIdentifier-4a67b082-0a4c-41cf-b6c7-440b29bb8c4f"


class Computer:
    def __init__(self, source, folder, kernel, columns=20, rows=10, padding=3, bits=32):
        self.script = source / "image/mkosi.images/initrd/mkosi.extra/usr/lib/cyclorama/tell-broken"
        self.root, self.columns, self.rows, self.stride = folder, columns, rows, (columns + padding) * 4
        for name in ("sys/firmware/efi/efivars", "sys/class/graphics/fb0", "usr/share/cyclorama", "dev"):
            (folder / name).mkdir(parents=True)
        if kernel is not None:
            (folder / "sys/firmware/efi/efivars" / STUB).write_bytes(b"\7\0\0\0" + f"\\EFI\\Linux\\{kernel}".encode("utf-16-le"))
        (folder / "usr/share/cyclorama/broken").write_bytes(f"{WIDTH} {HEIGHT}\n".encode() + PICTURE)
        for name, text in (("virtual_size", f"{columns},{rows}"), ("stride", self.stride), ("bits_per_pixel", bits)):
            (folder / "sys/class/graphics/fb0" / name).write_text(f"{text}\n")
        self.before = b"\xaa" * self.stride * rows
        (folder / "dev/fb0").write_bytes(self.before)

    def show(self):
        return subprocess.run(["sh", self.script], check=False, capture_output=True, env={"PATH": "/usr/bin:/bin", "CYCLORAMA_ROOT": str(self.root), "CYCLORAMA_SHOWN_S": "0"}).returncode

    def screen(self):
        return (self.root / "dev/fb0").read_bytes()

    def expected(self):
        """Returns the picture in the middle of black, cut where the screen is smaller."""
        screen = bytearray(len(self.before))
        left, top = max(0, self.columns - WIDTH) // 2, max(0, self.rows - HEIGHT) // 2
        shown = min(self.columns, WIDTH) * 4
        for row in range(min(HEIGHT, self.rows)):
            at = (top + row) * self.stride + left * 4
            screen[at:at + shown] = PICTURE[row * WIDTH * 4:row * WIDTH * 4 + shown]
        return bytes(screen)


def main(source):
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        cases = [("a version whose attempts are spent", "cyclorama-museum_1+0-3.efi", {}, True),
                 ("one that has some left", "cyclorama-museum_1+1-2.efi", {}, False),
                 ("one that is not counted", "cyclorama-museum_1.efi", {}, False),
                 ("a computer without UEFI", None, {}, False),
                 ("a screen that is smaller than the picture", "a_1+0-3.efi", {"columns": 6, "rows": 4, "padding": 0}, True),
                 ("a screen as large as the picture", "a_1+0-3.efi", {"columns": WIDTH, "rows": HEIGHT}, True),
                 ("a screen with other pixels", "a_1+0-3.efi", {"bits": 16}, False)]
        for number, (what, kernel, how, is_shown) in enumerate(cases):
            computer = Computer(pathlib.Path(source).resolve(), pathlib.Path(folder) / str(number), kernel, **how)
            is_right = computer.show() == 0 and computer.screen() == (computer.expected() if is_shown else computer.before)
            print(f"{'ok' if is_right else 'FAILED'}: {what}: {'the screen' if is_shown else 'nothing'}")
            bad += not is_right
    print("broken: ok" if bad == 0 else f"broken: {bad} failed")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
