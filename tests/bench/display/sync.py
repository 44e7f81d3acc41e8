# SPDX-License-Identifier: Apache-2.0
"""Measures whether several displays are synchronised: sync.py BUILD [--quick] [--seconds N] [--keep DIR].

It runs a tour, a farm of plain pictures (20 a second, all different), a visitor who turns, and real displays: each is a
process whose clock has an offset and a rate of its own, with heads in memory that refresh by that clock. Every display
logs which frame each refresh showed. The logs are compared

- by the refresh number that all displays share (the system's goal), and
- in true time, which only this machine knows: unsynchronised outputs differ by their phases, up to one refresh.
"""
import argparse
import bisect
import json
import pathlib
import signal
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from small_show import Processes, installation  # noqa: E402

WARM_UP_S = 10
# Clock offset, rate error and refresh rate. Real museums have a thousandth of the first two.
DISPLAYS = [
    {"skew-ms": 0, "drift-ppm": 0, "refresh-hz": 60},
    {"skew-ms": -1234.5, "drift-ppm": 60, "refresh-hz": 60},
    {"skew-ms": 86.4, "drift-ppm": -45, "refresh-hz": 59.97},
]


class Log:
    """The refreshes of one display after the warm-up."""

    def __init__(self, path):
        self.rows, self.gauges = [], {}
        for line in path.read_text(encoding="utf-8").splitlines():
            words = line.split()
            if words[0] == "#":
                self.gauges[" ".join(words[1:-1])] = float(words[-1])
            elif words[1] != "-":
                self.rows.append((int(words[0]), int(words[1]), int(words[2]), int(words[3]), int(words[4]), float(words[5])))
        if not self.rows:
            sys.exit(f"{path}: it was never synchronised")
        begin = self.rows[0][0] + WARM_UP_S * 1_000_000_000
        self.rows = [row for row in self.rows if row[0] >= begin]
        self.numbers = sorted({row[1] for row in self.rows})
        self.by_number = {row[1]: row for row in self.rows}
        self.times = [row[0] for row in self.rows]

    def at(self, number):
        """Returns the row of that refresh number; a skipped refresh shows the previous frame."""
        return self.by_number[self.numbers[bisect.bisect_right(self.numbers, number) - 1]]

    def seen(self, t):
        return self.rows[bisect.bisect_right(self.times, t) - 1]


def compare(logs):
    first = max(log.numbers[0] for log in logs)
    last = min(log.numbers[-1] for log in logs)
    rank = {frame: n for n, frame in enumerate(sorted({row[2] for log in logs for row in log.rows}))}
    refreshes, agreeing, headings, differences = 0, 0, 0, {}
    for number in range(first, last + 1):
        rows = [log.at(number) for log in logs]
        ranks = [rank[row[2]] for row in rows]
        apart = max(ranks) - min(ranks)
        refreshes += 1
        agreeing += apart == 0
        differences[apart] = differences.get(apart, 0) + 1
        headings += len({row[5] for row in rows}) == 1
    begin, end = max(log.times[0] for log in logs), min(log.times[-1] for log in logs)
    moments = sorted({t for log in logs for t in log.times if begin <= t < end})
    agreeing_ns, largest = 0, 0
    for t, following in zip(moments, moments[1:]):
        ranks = [rank[log.seen(t)[2]] for log in logs]
        largest = max(largest, max(ranks) - min(ranks))
        agreeing_ns += (following - t) if max(ranks) == min(ranks) else 0
    return {
        "agree_fraction": round(agreeing / refreshes, 6),
        "max_difference": max(max(differences), largest),
        "refreshes": refreshes,
        "frames": len(rank),
        "heading_agree_fraction": round(headings / refreshes, 6),
        "agree_time_fraction": round(agreeing_ns / (moments[-1] - moments[0]), 4),
    }


def run(build, seconds, folder):
    displays, logs = [], []
    with Processes(build) as processes:
        farm, address = processes.start_tour()
        for n, display in enumerate(DISPLAYS):
            (folder / f"room-{n}.toml").write_text(installation(f"head-{n}", 52 * (n - 1)), encoding="utf-8")
            options = [word for name, value in display.items() for word in (f"--{name}", value)]
            logs.append(folder / f"display-{n}.log")
            displays.append(processes.start("tests/test-display", "--installation", folder / f"room-{n}.toml", "--tour", address,
                                            "--width", 512, "--log", logs[-1], *options))
        farm.stdin.write(address + "\n")
        farm.stdin.flush()
        time.sleep(WARM_UP_S + 2 + seconds)
        farm.send_signal(signal.SIGTERM)
        printed = farm.communicate(timeout=30)[0].splitlines()
        for child in displays:
            child.send_signal(signal.SIGTERM)
        for child in displays:
            if child.wait(timeout=30) != 0:
                sys.exit("a display failed")
    return [Log(path) for path in logs], printed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--keep", type=pathlib.Path, help="leaves the logs in this folder")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep or pathlib.Path(temporary)
        folder.mkdir(exist_ok=True)
        logs, printed = run(args.build.resolve(), args.seconds or (30 if args.quick else 120), folder)
    figures = compare(logs)
    gauges = dict(line.rsplit(" ", 1) for line in printed[:-1])
    print(f"{'display':<9}{'clock ahead':>13}{'faster':>10}{'rate':>10}{'measured ahead':>18}{'late frames':>13}"
          f"{'late headings':>15}{'in sync':>11}")
    worst_skew_ms = 0.0
    for n, (display, log) in enumerate(zip(DISPLAYS, logs)):
        worst_skew_ms = max(worst_skew_ms, abs(log.gauges["clock_skew_ms"] - display["skew-ms"]))
        print(f"{n:<9}{display['skew-ms']:>10.1f} ms{display['drift-ppm']:>6} ppm{display['refresh-hz']:>7.2f} Hz"
              f"{log.gauges['clock_skew_ms']:>10.2f} ± {log.gauges['clock_error_ms']:.2f}"
              f"{sum(row[3] > 0 for row in log.rows):>13}{sum(row[4] > 0 for row in log.rows):>15}"
              f"{log.gauges['synchronised_percent']:>10.3f} %")
    print(f"the tour reports: {printed[-1]}")
    for name, gauge in (("frame_lead_ms", "frame_lead_ms"), ("heading_lead_ms", "heading_lead_ms")):
        figures[name] = round(float(gauges[gauge]), 1)
    print(json.dumps({"benchmark": "display-sync", **figures, "displays": len(logs),
                      "max_skew_error_ms": round(worst_skew_ms, 3)}))


main()
