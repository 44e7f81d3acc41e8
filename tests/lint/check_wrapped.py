#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if the DRM output calls something of libdrm, GBM, EGL or udev that the fake card does not answer: then tests would
reach for a real card, and the faults' benchmark would leave a call out.

Run: check_wrapped.py SOURCE_ROOT
"""
import pathlib
import re
import sys

CALL = re.compile(r"\b(drm[A-Z]\w+|gbm_\w+|egl[A-Z]\w+|udev_\w+)(?=\(|>>)")
# They ask nothing of a card and cannot fail.
HARMLESS = {"drmModeGetConnectorTypeName", "eglGetError", "eglReleaseThread"}


def main(root):
    root = pathlib.Path(root)
    called = set()
    for file in (root / "drivers/output/drm").glob("*.*"):
        code = re.sub(r"//.*", "", file.read_text(encoding="utf-8"))
        called |= set(CALL.findall(code))
    listed = (root / "tests/doubles/fake_card/CMakeLists.txt").read_text(encoding="utf-8")
    wrapped = set(re.search(r"set\(wrapped(.*?)\)", listed, re.DOTALL)[1].split())
    bad = [f"tests/doubles/fake_card: does not wrap {name}" for name in sorted(called - wrapped - HARMLESS)]
    bad += [f"tests/doubles/fake_card: wraps {name}, which nobody calls" for name in sorted(wrapped - called - {"open", "close"})]
    print("\n".join(bad) or f"wrapped: ok, {len(called)} calls")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
