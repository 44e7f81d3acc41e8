# SPDX-License-Identifier: Apache-2.0
"""What can go wrong. Each fault happens to a whole farm, is seen through, and leaves a whole farm behind."""
import signal
import threading
import time

from farm.museum import now
from farm.processes import wait_until

HELD_S = 2.0  # How long a fault that passes lasts: longer than a full rate takes to come back.
HANG_S = 10.0  # Without a frame, though there are nodes.
LIMIT_S = 12.0  # Nobody waits longer for a full rate.
SLOW_PERIOD_S = 0.05
SLOWED = 10.0


class Slowed:
    """A process that runs a tenth of the time."""

    def __init__(self, process):
        self.process, self.over = process, threading.Event()
        self.thread = threading.Thread(target=self._run)
        self.thread.start()

    def _run(self):
        while not self.over.is_set():
            self.process.send(signal.SIGSTOP)
            self.over.wait(SLOW_PERIOD_S * (1.0 - 1.0 / SLOWED))
            self.process.send(signal.SIGCONT)
            time.sleep(SLOW_PERIOD_S / SLOWED)

    def end(self):
        self.over.set()
        self.thread.join()


class Fault:
    """`hurts`: whose visits it may end: nobody's, everybody's ("head"), or the one's that it happens to ("museum").
    `to_node`: at most one frame may be late. `heads`: so many are needed. `node_comes`: in the end, a node joins."""

    def __init__(self, kind, happen, passes=None, hurts="none", to_node=False, heads=1, node_comes=False):
        self.kind, self.happen, self.passes, self.hurts = kind, happen, passes, hurts
        self.to_node, self.heads, self.node_comes = to_node, heads, node_comes


def some_node(farm, lots):
    return lots.choice(farm.nodes)


def some_museum(farm, lots):
    return farm.museums[lots.choice(sorted(farm.museums))]


def kill_node(farm, lots):
    node = some_node(farm, lots)
    node.process.kill()
    return node


def start_again(_, part):
    part.start()


def restart_node(farm, lots):
    node = kill_node(farm, lots)
    node.start()
    return node


def stop_node(farm, lots):
    node = some_node(farm, lots)
    node.process.send(signal.SIGSTOP)
    return node


def continue_(_, part):
    part.process.send(signal.SIGCONT)


def slow_node(farm, lots):
    return Slowed(some_node(farm, lots).process)


def cut_node(farm, lots):
    node = some_node(farm, lots)
    for link in node.links:
        link.cut()
    return node


def restore(_, part):
    for link in part.links:
        link.restore()


def reset_node(farm, lots):
    for link in some_node(farm, lots).links:
        link.reset(downwards=False)


def join_node(farm, _):
    return farm.add_node()


def drop_node(farm, node):
    farm.drop_node(node)


def drain_node(farm, lots):
    node = some_node(farm, lots)
    farm.stuck += not node.process.end()
    return node


def busiest_head(farm):
    """Where most museums are."""
    return max(farm.heads, key=lambda head: sum(
        len(museum.links[farm.heads.index(head)].writers) for museum in farm.museums.values()))


def restart_head(farm, lots):
    lose_head(farm, lots).start()


def lose_head(farm, lots):
    """While it is away the other must take over."""
    head = busiest_head(farm)
    head.process.kill()
    return head


def pause_head(farm, lots):
    head = busiest_head(farm)
    head.process.send(signal.SIGSTOP)
    time.sleep(1.0)
    head.process.send(signal.SIGCONT)


def restart_museum(farm, lots):
    museum = some_museum(farm, lots)
    museum.kill()
    options, picture = museum.asked
    return farm.add_museum(museum.name, *options, **picture)


def pause_museum(farm, lots):
    museum = some_museum(farm, lots)
    museum.process.send(signal.SIGSTOP)
    return museum


def cut_museum(farm, lots):
    museum = some_museum(farm, lots)
    for link in museum.links:
        link.cut()
    return museum


def reset_museum(farm, lots):
    museum = some_museum(farm, lots)
    for link in museum.links:
        link.reset(downwards=True)
    return museum


def nothing(farm, lots):
    """What is seen of this is the machine's doing."""
    time.sleep(HELD_S)


ALL = [
    Fault("nothing happens", nothing),
    Fault("node killed", kill_node, start_again, to_node=True, node_comes=True),
    Fault("node restarted", restart_node, to_node=True, node_comes=True),
    Fault("node stopped", stop_node, continue_, to_node=True),
    Fault("node slowed 10x", slow_node, lambda _, slowed: slowed.end(), to_node=True),
    Fault("node cut off", cut_node, restore, to_node=True),
    Fault("node's connection reset", reset_node, to_node=True),
    Fault("node joins, then leaves", join_node, drop_node, to_node=True),
    Fault("node asked to stop", drain_node, start_again, to_node=True, node_comes=True),
    Fault("head restarted", restart_head, hurts="head"),
    Fault("head stopped for 1 s", pause_head, hurts="head"),
    Fault("head lost, the other takes over", lose_head, start_again, hurts="head", heads=2),
    Fault("museum restarted", restart_museum, hurts="museum"),
    Fault("museum reads nothing", pause_museum, continue_, hurts="museum"),
    Fault("museum cut off", cut_museum, restore, hurts="museum"),
    Fault("museum's connection reset", reset_museum, hurts="museum"),
]


def seconds_to_full_rate(museum, since):
    """LIMIT_S: not even within that."""
    while (at := museum.at_full_rate(since)) is None:
        if now() > since + LIMIT_S:
            return LIMIT_S
        time.sleep(0.05)
    return at - since


def most_seconds_to_full_rate(museums, since):
    """Waits for all; who rests now and then is not in the figure."""
    seconds = [(seconds_to_full_rate(museum, since), museum.rests) for museum in museums]
    return max([figure for figure, rests in seconds if not rests], default=0.0)


def seconds_to_take_part(farm, node, limit_s):
    """From the head's word that the node has the scene to the first frame that all nodes made. None: not seen; a picture
    may be too small for one more."""
    museum = next(iter(farm.museums.values()))
    wait_until(lambda: node.is_ready(), 30, f"{node.name} has the scene")
    ready = now()
    while now() < ready + limit_s:
        for frame in museum.whole_frames(ready):
            if frame["nodes"] == len(farm.nodes):
                return frame["begun_s"] - ready
        time.sleep(0.05)
    return None


def lost_by(museum, fault, is_struck, since):
    """Visits that ended though the fault was somebody else's, or that are not open again though it has passed."""
    lost, opened = museum.events("lost", since), museum.events("opened", since)
    if fault.hurts == "head" or is_struck:
        return int(bool(lost) and not opened)
    return len(lost)


def see_through(fault, farm, lots, late_after_s):
    """Lets it happen and pass. Returns what was seen of it."""
    began = passed = now()
    thing = fault.happen(farm, lots)
    struck = thing if fault.hurts == "museum" else None
    others = [museum for museum in farm.museums.values() if museum is not struck]
    seconds = most_seconds_to_full_rate(others, began)
    if fault.passes:
        time.sleep(max(0.0, began + HELD_S - now()))
        passed = now()
        fault.passes(farm, thing)
    joined = seconds_to_take_part(farm, thing, 3.0) if fault.node_comes else None
    seconds = max(seconds, most_seconds_to_full_rate(farm.museums.values(), passed))
    time.sleep(0.3)
    end = now()
    # When it happened, and once more when it passed: each counts for itself.
    late = [museum.late_frames(a, b, late_after_s) for museum in others for a, b in ((began, passed), (passed, end)) if a < b]
    return {
        "kind": fault.kind, "began_s": began, "to_node": fault.to_node, "full_rate_s": seconds, "joined_s": joined,
        "hangs": sum(m.longest_gap(passed if m is struck else began, end) >= HANG_S for m in farm.museums.values()),
        "late": max(map(len, late), default=0),
        "reasons": sorted({frame["reason"] or f"after {frame['at_s'] - frame['asked_s']:.1f} s" for some in late for frame in some}),
        "lost_sessions": sum(lost_by(m, fault, m is struck, began) for m in farm.museums.values()),
    }
