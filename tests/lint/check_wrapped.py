#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails if the DRM output calls something of libdrm, GBM, EGL or udev that the fake card does not answer, or the V4L2 camera
something of the system that the fake video device does not: then tests would reach for real devices, and the tests of
faults would leave a call out.

Run: check_wrapped.py SOURCE_ROOT
"""
import pathlib
import re
import sys

CARD_CALL = re.compile(r"\b(drm[A-Z]\w+|gbm_\w+|egl[A-Z]\w+|udev_\w+)(?=\(|>>)")
# They ask nothing of a card and cannot fail.
HARMLESS = {"drmModeGetConnectorTypeName", "eglGetError", "eglReleaseThread"}
SYSTEM_CALL = re.compile(r"(?<![\w>)])::(\w+)\(")
HARMLESS_SYSTEM = {"strnlen"}
REQUEST = re.compile(r"\bVIDIOC_\w+")
# Calls of the system, and those of headers that the drivers include.
BY_HEADERS = {"open", "close", "ioctl", "poll"}


def code_of(root, folder):
    return [re.sub(r"//.*", "", file.read_text(encoding="utf-8")) for file in (root / folder).glob("*.*")
            if file.suffix in (".h", ".cpp")]


def wrapped_by(root, double):
    listed = (root / double / "CMakeLists.txt").read_text(encoding="utf-8")
    return set(re.search(r"set\(wrapped(.*?)\)", listed, re.DOTALL)[1].split())


def compare(root, folder, double, call, harmless):
    """(what is wrong, number of calls) of a driver's folder and the double that stands in for the system."""
    called = {name for code in code_of(root, folder) for name in call.findall(code)} - harmless
    wrapped = wrapped_by(root, double)
    bad = [f"{double}: does not wrap {name}" for name in sorted(called - wrapped)]
    bad += [f"{double}: wraps {name}, which nobody calls" for name in sorted(wrapped - called - BY_HEADERS)]
    return bad, len(called)


def main(root):
    root = pathlib.Path(root)
    bad, card_calls = compare(root, "drivers/output/drm", "tests/doubles/fake_card", CARD_CALL, HARMLESS)
    worse, video_calls = compare(root, "drivers/camera/v4l2", "tests/doubles/fake_video", SYSTEM_CALL, HARMLESS_SYSTEM)
    bad += worse
    asked = {name for code in code_of(root, "drivers/camera/v4l2") for name in REQUEST.findall(code)}
    answered = {name for code in code_of(root, "tests/doubles/fake_video") for name in REQUEST.findall(code)}
    bad += [f"tests/doubles/fake_video: does not answer {name}" for name in sorted(asked - answered)]
    print("\n".join(bad) or f"wrapped: ok, {card_calls} calls of a card, {video_calls} and {len(asked)} requests of a camera")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
