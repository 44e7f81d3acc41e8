# SPDX-License-Identifier: Apache-2.0
"""A museum: the program test-museum, and the frames that it has received."""
import json
import statistics
import threading
import time

from farm.processes import Process

RUN = 10  # So many whole frames in a row at the requested rate count as the full rate.


class Museum:
    def __init__(self, name, program, folder, coordinators, rate_hz, options=(), host=()):
        self.name, self.rate_hz, self.lines, self.lock = name, rate_hz, [], threading.Lock()
        self.rests = "--rest-s" in options
        command = [*host, program, "--museum", name, "--rate-hz", rate_hz, *options]
        for coordinator in coordinators:
            command += ["--farm", coordinator]
        self.process = Process(name, command, folder, piped=True)
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for text in self.process.popen.stdout:
            line = json.loads(text)
            with self.lock:
                self.lines.append(line)

    def events(self, kind, since=0.0, until=float("inf")):
        with self.lock:
            return [line for line in self.lines if line["event"] == kind and since <= line["at_s"] < until]

    def frames(self, since=0.0, until=float("inf")):
        """Returns the whole frames of requested views; refined pictures at rest are no new frames."""
        return [f for f in self.events("frame", since, until) if not f["refined"]]

    def whole_frames(self, since=0.0, until=float("inf")):
        return [f for f in self.frames(since, until) if f["complete"]]

    def late_frames(self, since, until, limit_s):
        """Returns the frames that were not completed, or only after `limit_s`."""
        return [f for f in self.frames(since, until)
                if not f["complete"] or f["at_s"] - f.get("asked_s", f["at_s"]) > limit_s]

    def wrong(self):
        """Returns the errors that no farm may cause: (holes, breaches of farm.proto)."""
        return (sum(not f["whole"] for f in self.events("frame") if f["complete"]),
                [v["reason"] for v in self.events("violation")])

    def at_full_rate(self, since):
        """Returns the time after `since` from which every frame was in time, or None."""
        frames = self.frames(since)
        max_s = 1.5 * RUN / self.rate_hz
        for first in range(len(frames) - RUN):
            run = frames[first:first + RUN + 1]
            if all(f["complete"] for f in run) and run[-1]["at_s"] - run[0]["at_s"] <= max_s:
                return run[0]["at_s"]
        return None

    def max_gap(self, since, until):
        times = [since] + [f["at_s"] for f in self.whole_frames(since, until)] + [until]
        return max(b - a for a, b in zip(times, times[1:]))

    def latency_s(self, since):
        frames = [f["at_s"] - f["asked_s"] for f in self.whole_frames(since) if "asked_s" in f]
        return statistics.median(frames) if frames else float("nan")

    def end(self):
        """Ends the museum. Returns False if it had to be killed."""
        ended = self.process.end()
        self.reader.join(20)
        return ended

    def kill(self):
        self.process.kill()
        self.reader.join(20)


def now():
    """Returns the time on the clock of all events."""
    return time.monotonic()
