# SPDX-License-Identifier: Apache-2.0
"""Measures the time from a turned wand to a changed wall, through the real processes.

Run: motion_to_photon.py BUILD [--quick] [--camera-hz N]

A simulated hand holds a wand still and turns it abruptly, again and again, at times known to the nanosecond. The real
cyclorama-tracker sees that in its pictures, the real cyclorama-tour steers, and the real cyclorama-display turns the
picture of its head. The head's pixels, published with the time of their refresh, are compared with the previous ones:

    wand turns ──▶ next exposure ──▶ picture ──▶ detect, pose ──▶ steer ──▶ next refresh ──▶ the first pixels that differ

Only pixels go in and only pixels come out. The farm's pictures are stripes that are fixed in the scene, so a new frame
changes nothing: the first change is the heading that the display applies, which needs no ray.

The times of the turns on this machine's clock come from the tracker's OSC: picture n was exposed at begin + n / rate.
"""
import argparse
import json
import mmap
import pathlib
import random
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from small_show import Processes, installation  # noqa: E402

TURN_DEG = 25
STEP_S = 0.002  # Duration of the turn; time is measured from its start.
HELD_S = 0.4  # The wand stays turned for so long, then straight until all is at rest.
PULSES = 8  # Turns per loop, alternately right and left, at irregular intervals.
QUIET_S = 0.12  # A turn counts only if nothing changed for so long before it.
LATEST_S = 0.5


def hand(camera_hz):
    """Returns the text of the hand's file and the times in its loop at which the wand turns."""
    rng = random.Random(7)
    keys, turns, at = [], [], 0.5
    for n in range(PULSES):
        yaw = TURN_DEG if n % 2 == 0 else -TURN_DEG
        turns.append(at)
        keys += [(at, 0), (at + STEP_S, yaw), (at + HELD_S, yaw), (at + HELD_S + STEP_S, 0)]
        at += HELD_S + 1.6 + rng.random() * 0.2
    text = f"[camera]\nframes_per_second = {camera_hz}\n[path]\nloop_s = {at:.4f}\n"
    for t, yaw in [(0.0, 0)] + keys:
        text += f"[[path.key]]\ntime_s = {t:.4f}\nposition_m = [0.0, 0.05, 1.0]\nyaw_deg = {yaw}\npitch_deg = 8.0\nroll_deg = 0.0\n"
    return text, turns, round(at, 4)


class Poses(threading.Thread):
    """Receives the tracker's messages with the times of their arrival."""

    def __init__(self):
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
        self.socket.bind(("::1", 0))
        self.socket.settimeout(0.5)
        self.rows, self.going = [], True

    def run(self):
        while self.going:
            try:
                message = self.socket.recv(2048)
            except TimeoutError:
                continue
            now = time.monotonic_ns()
            end = message.index(b"\0")
            if message[:end] != b"/cyclorama/pose":
                continue
            tags_at = (end // 4 + 1) * 4
            tags_end = message.index(b"\0", tags_at)
            tags, at = message[tags_at + 1:tags_end].decode(), (tags_end // 4 + 1) * 4
            values = struct.unpack_from(">" + tags.replace("h", "q"), message, at)
            _, sequence, shutter_ns, _, _, _, w, _, y, _ = values
            self.rows.append((sequence, shutter_ns, now, 2 * y * w))


class Head(threading.Thread):
    """Records when a head's picture changed."""

    def __init__(self, path):
        super().__init__(daemon=True)
        self.path, self.going = path, True
        self.changes = []  # (time of the refresh in ns, pixels that differ by more than 8 code values)

    def run(self):
        with open(self.path, "rb") as file:
            shared = mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ)
        width, height = struct.unpack_from("=II", shared, 12)
        size, words = width * height * 3, (width * height * 3 + 7) // 8
        started, published, slots, pixels = 24, 32, 40, 40 + 2 * 16
        last, before = 0, b""
        while self.going:
            number = struct.unpack_from("=Q", shared, published)[0]
            if number == last:
                time.sleep(0.0005)
                continue
            presented = struct.unpack_from("=q", shared, slots + 16 * (number % 2) + 8)[0]
            begin = pixels + 8 * words * (number % 2)
            picture = shared[begin:begin + size]
            if struct.unpack_from("=Q", shared, started)[0] >= number + 2:
                continue  # It was overwritten; the next one is there.
            last = number
            if picture != before:
                # One row is enough to see vertical stripes move.
                row = len(picture) // 2 - len(picture) // 2 % (3 * width)
                much = sum(abs(a - b) > 8
                           for a, b in zip(picture[row:row + 3 * width:3], before[row:row + 3 * width:3]))
                self.changes.append((presented, much))
                before = picture


def quantile(values, part):
    values = sorted(values)
    return values[min(len(values) - 1, int(part * len(values)))] if values else None


def measure(build, camera_hz, refresh_hz, seconds, folder):
    text, turns, loop_s = hand(camera_hz)
    (folder / "hand.toml").write_text(text, encoding="utf-8")
    (folder / "room.toml").write_text(installation("head"), encoding="utf-8")
    poses = Poses()
    poses.start()
    picture = folder / "head-head.picture"
    with Processes(build) as processes:
        _, address = processes.start_tour("--striped")
        processes.start("bin/cyclorama-display", "--installation", folder / "room.toml", "--tour", address,
                        "--width", 768, "--run-dir", folder, "--refresh-hz", refresh_hz, stderr=subprocess.DEVNULL)
        processes.start("bin/cyclorama-tracker", "--camera", f"simulated:{folder}/hand.toml", "--tour", address,
                        "--listen", "[::1]:0", "--osc", f"[::1]:{poses.socket.getsockname()[1]}",
                        stderr=subprocess.DEVNULL)
        while not picture.exists():
            time.sleep(0.05)
        head = Head(picture)
        head.start()
        time.sleep(seconds + 3)
        for child in processes.children:
            if child.poll() is not None:
                sys.exit(f"{child.args[0]} ended")
        head.going = poses.going = False
    return turns, loop_s, poses.rows, head.changes


def latencies(turns, loop_s, camera_hz, poses, changes):
    begin = min(shutter - sequence * 1e9 / camera_hz for sequence, shutter, _, _ in poses)
    first = changes[0][0] + 3e9
    rows, unquiet = [], 0
    for n in range(int((changes[-1][0] - begin) / 1e9 / loop_s) + 1):
        for turn in turns:
            t = begin + (n * loop_s + turn) * 1e9
            if t < first or t + LATEST_S * 1e9 > changes[-1][0]:
                continue
            if any(t - QUIET_S * 1e9 < at < t for at, _ in changes):
                unquiet += 1
                continue
            seen = next((at for at, _ in changes if at >= t), None)
            plain = next((at for at, much in changes if at >= t and much >= 3), None)
            pose = next((row for row in poses if row[1] >= t - 5e6 and abs(row[3]) > 0.02), None)
            if seen is None or seen - t > LATEST_S * 1e9 or pose is None:
                rows.append(None)  # A turn that was never seen is worse than any number.
                continue
            rows.append({"all": (seen - t) / 1e6, "plain": (plain - t) / 1e6 if plain else LATEST_S * 1e3,
                         "shutter": max(0.0, (pose[1] - t) / 1e6), "tracker": (pose[2] - max(pose[1], t)) / 1e6,
                         "wall": (seen - pose[2]) / 1e6})
    return rows, unquiet


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--camera-hz", type=float, action="append")
    parser.add_argument("--refresh-hz", type=float, default=60)
    args = parser.parse_args()
    seconds = args.seconds or (40 if args.quick else 200)
    result = {}
    print(f"{'camera':<9}{'turns':>6}{'not seen':>10}{'p50':>9}{'p95':>9}{'max':>9}"
          "   of p50: until the shutter, tracker, tour and display;  clearly seen p95")
    for camera_hz in args.camera_hz or [30, 60]:
        with tempfile.TemporaryDirectory() as folder:
            turns, loop_s, poses, changes = measure(args.build.resolve(), camera_hz, args.refresh_hz, seconds,
                                                    pathlib.Path(folder))
        rows, unquiet = latencies(turns, loop_s, camera_hz, poses, changes)
        seen = [row for row in rows if row]
        if not seen:
            sys.exit("no turn was seen at rest: is the machine too busy?")
        missed = len(rows) - len(seen)
        every = [row["all"] for row in seen] + [LATEST_S * 1e3] * missed
        part = {name: quantile([row[name] for row in seen], 0.5) for name in ("shutter", "tracker", "wall")}
        figures = {"p50_ms": quantile(every, 0.5), "p95_ms": quantile(every, 0.95), "max_ms": max(every),
                   "turns": len(rows),
                   "not_seen": missed, "not_at_rest": unquiet,
                   "plain_p95_ms": quantile([row["plain"] for row in seen], 0.95),
                   **{f"{name}_p50_ms": value for name, value in part.items()}}
        result[f"{camera_hz:.0f}"] = {name: round(value, 1) for name, value in figures.items()}
        print(f"{camera_hz:>3.0f} /s   {len(rows):>6}{missed:>10}{figures['p50_ms']:>6.1f} ms{figures['p95_ms']:>6.1f} ms{figures['max_ms']:>6.1f} ms"
              f"   {part['shutter']:>22.1f} {part['tracker']:>11.1f} {part['wall']:>13.1f}        {figures['plain_p95_ms']:>18.1f}")
    first = next(iter(result.values()))
    print(json.dumps({"benchmark": "motion-to-photon", "p50_ms": first["p50_ms"], "p95_ms": first["p95_ms"],
                      "by_camera_hz": result}))


main()
