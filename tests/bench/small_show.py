# SPDX-License-Identifier: Apache-2.0
"""A room with one projector, a farm of simple pictures and a tour, for measurements of whole displays."""
import re
import subprocess
import sys
import threading

ROOM = """name = "One projector"
[wall]
shape = "cylinder"
radius_m = 3.0
arc_deg = 126
bottom_m = 0.4
top_m = 2.9
[visitor]
eye_m = [0.0, 1.65, 0.0]
[[projector]]
name = "{0}"
width_px = 320
height_px = 240
field_of_view_deg = 60
lens_shift_fraction = [0.0, -0.36]
position_m = [0.0, 2.75, 0.4]
pan_deg = {1}
tilt_deg = -3
"""


def installation(projector, pan_deg=0):
    """Returns the text of an installation.toml."""
    return ROOM.format(projector, pan_deg)


class Processes:
    """Child processes, which the end of the `with` kills, the newest first."""

    def __init__(self, build):
        self.build, self.children = build, []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for child in reversed(self.children):
            child.kill()
            child.wait()

    def start(self, program, *words, **options):
        self.children.append(subprocess.Popen([str(word) for word in (self.build / program, *words)], text=True,
                                              **options))
        return self.children[-1]

    def start_tour(self, *farm_words):
        """Starts farm and tour. Returns the farm and the tour's address."""
        farm = self.start("tests/test-farm", *farm_words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        port = farm.stdout.readline().split()[1]
        tour = self.start("bin/cyclorama-tour", "--listen", "[::1]:0", "--farm", f"[::1]:{port}", "--samples", 1,
                          stderr=subprocess.PIPE)
        for line in tour.stderr:
            if found := re.search(r"\(port (\d+)\)", line):
                threading.Thread(target=tour.stderr.read, daemon=True).start()
                return farm, f"[::1]:{found[1]}"
        sys.exit("the tour did not start")
