# SPDX-License-Identifier: Apache-2.0
"""Faults. Each one is injected into an intact farm and watched until the farm is intact again."""
import signal
import threading
import time

from farm.museum import now
from farm.processes import wait_until

HELD_S = 2.0  # Duration of a passing fault: longer than the full rate takes to return.
HANG_S = 10.0  # Without a frame, although there are nodes, for so long: a hang.
LIMIT_S = 12.0  # A farm that has no full rate after so long has failed.
SLOW_PERIOD_S = 0.05
SLOWED = 10.0


class Slowed:
    """Slows a process to a tenth of its speed."""

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
    """A fault. `hurts`: whose sessions it may end: nobody's, all ("coordinator"), or those of the affected museum ("museum").
    `to_node`: at most one frame may be late. `coordinators`: the number of coordinators needed. `node_comes`: a node joins at
    the end."""

    def __init__(self, kind, happen, passes=None, hurts="none", to_node=False, coordinators=1, node_comes=False):
        self.kind, self.happen, self.passes, self.hurts = kind, happen, passes, hurts
        self.to_node, self.coordinators, self.node_comes = to_node, coordinators, node_comes


def some_node(farm, rng):
    return rng.choice(farm.nodes)


def some_museum(farm, rng):
    return farm.museums[rng.choice(sorted(farm.museums))]


def kill_node(farm, rng):
    node = some_node(farm, rng)
    node.process.kill()
    return node


def start_again(_, part):
    part.start()


def restart_node(farm, rng):
    node = kill_node(farm, rng)
    node.start()
    return node


def stop_node(farm, rng):
    node = some_node(farm, rng)
    node.process.send(signal.SIGSTOP)
    return node


def continue_(_, part):
    part.process.send(signal.SIGCONT)


def slow_node(farm, rng):
    return Slowed(some_node(farm, rng).process)


def cut_node(farm, rng):
    node = some_node(farm, rng)
    for link in node.links:
        link.cut()
    return node


def restore(_, part):
    for link in part.links:
        link.restore()


def reset_node(farm, rng):
    for link in some_node(farm, rng).links:
        link.reset(downwards=False)


def join_node(farm, _):
    return farm.add_node()


def drop_node(farm, node):
    farm.drop_node(node)


def drain_node(farm, rng):
    node = some_node(farm, rng)
    farm.stuck += not node.process.end()
    return node


def busiest_coordinator(farm):
    """Returns the coordinator that has most museums."""
    return max(farm.coordinators, key=lambda coordinator: sum(
        len(museum.links[farm.coordinators.index(coordinator)].writers) for museum in farm.museums.values()))


def restart_coordinator(farm, rng):
    lose_coordinator(farm, rng).start()


def lose_coordinator(farm, rng):
    """Stops a coordinator, which the other one must replace meanwhile."""
    coordinator = busiest_coordinator(farm)
    coordinator.process.kill()
    return coordinator


def pause_coordinator(farm, rng):
    coordinator = busiest_coordinator(farm)
    coordinator.process.send(signal.SIGSTOP)
    time.sleep(1.0)
    coordinator.process.send(signal.SIGCONT)


def restart_museum(farm, rng):
    museum = some_museum(farm, rng)
    museum.kill()
    options, picture = museum.requested
    return farm.add_museum(museum.name, *options, **picture)


def pause_museum(farm, rng):
    museum = some_museum(farm, rng)
    museum.process.send(signal.SIGSTOP)
    return museum


def cut_museum(farm, rng):
    museum = some_museum(farm, rng)
    for link in museum.links:
        link.cut()
    return museum


def reset_museum(farm, rng):
    museum = some_museum(farm, rng)
    for link in museum.links:
        link.reset(downwards=True)
    return museum


def nothing(farm, rng):
    """Does nothing: what is then observed is caused by the machine."""
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
    Fault("node stopped on request", drain_node, start_again, to_node=True, node_comes=True),
    Fault("coordinator restarted", restart_coordinator, hurts="coordinator"),
    Fault("coordinator stopped for 1 s", pause_coordinator, hurts="coordinator"),
    Fault("coordinator lost, the other takes over", lose_coordinator, start_again, hurts="coordinator", coordinators=2),
    Fault("museum restarted", restart_museum, hurts="museum"),
    Fault("museum reads nothing", pause_museum, continue_, hurts="museum"),
    Fault("museum cut off", cut_museum, restore, hurts="museum"),
    Fault("museum's connection reset", reset_museum, hurts="museum"),
]


def seconds_to_full_rate(museum, since):
    """Returns the seconds, or LIMIT_S if it took longer."""
    while (at := museum.at_full_rate(since)) is None:
        if now() > since + LIMIT_S:
            return LIMIT_S
        time.sleep(0.05)
    return at - since


def max_seconds_to_full_rate(museums, since):
    """Waits for all museums and returns the seconds; visitors who rest at times are not counted."""
    seconds = [(seconds_to_full_rate(museum, since), museum.rests) for museum in museums]
    return max([figure for figure, rests in seconds if not rests], default=0.0)


def seconds_to_take_part(farm, node, limit_s):
    """Returns the seconds from the coordinator's log of the scene on the node to the first frame of all nodes. None if
    there was none: a picture may be too small for one node more."""
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
    """Returns the sessions that ended through another's fault, or are not open again after their own has passed."""
    lost, opened = museum.events("lost", since), museum.events("opened", since)
    if fault.hurts == "coordinator" or is_struck:
        return int(bool(lost) and not opened)
    return len(lost)


def see_through(fault, farm, rng, late_after_s):
    """Injects a fault, waits until it has passed, and returns the observations."""
    began = passed = now()
    thing = fault.happen(farm, rng)
    struck = thing if fault.hurts == "museum" else None
    others = [museum for museum in farm.museums.values() if museum is not struck]
    seconds = max_seconds_to_full_rate(others, began)
    if fault.passes:
        time.sleep(max(0.0, began + HELD_S - now()))
        passed = now()
        fault.passes(farm, thing)
    joined = seconds_to_take_part(farm, thing, 3.0) if fault.node_comes else None
    seconds = max(seconds, max_seconds_to_full_rate(farm.museums.values(), passed))
    time.sleep(0.3)
    end = now()
    # Its begin and its end count separately.
    late = [museum.late_frames(a, b, late_after_s) for museum in others for a, b in ((began, passed), (passed, end)) if a < b]
    return {
        "kind": fault.kind, "began_s": began, "to_node": fault.to_node, "full_rate_s": seconds, "joined_s": joined,
        "hangs": sum(m.max_gap(passed if m is struck else began, end) >= HANG_S for m in farm.museums.values()),
        "late": max(map(len, late), default=0),
        "reasons": sorted({frame["reason"] or f"after {frame['at_s'] - frame['asked_s']:.1f} s" for some in late for frame in some}),
        "lost_sessions": sum(lost_by(m, fault, m is struck, began) for m in farm.museums.values()),
    }
