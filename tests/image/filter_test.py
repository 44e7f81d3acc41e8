#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the museum's packet filter in two network namespaces: somebody who opens 900 connections to the operator page at
once keeps out nobody else, other ports are closed, and alarms may leave for mail servers and webhooks.

Run: filter_test.py SOURCE_ROOT      It is skipped (77) without root or nft (package nftables).
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
# Runs in namespaces of its own, so that nothing of this computer changes.
ROOM = """set -e
mount -t tmpfs tmpfs /run
ip link set lo up
nft -f "$1"
ip netns add outside
ip link add inside type veth peer name outside netns outside
ip address add 10.9.0.1/24 dev inside
ip link set inside up
for host in 2 3; do ip -n outside address add 10.9.0.$host/24 dev outside; done
ip -n outside link set outside up
mkfifo /run/ready
python3 -c "$2" >/run/ready &
read -r _ </run/ready
ip netns exec outside python3 -c "$3" || echo "it failed"
kill $!
mkfifo /run/listens
ip netns exec outside python3 -c "$4" >/run/listens &
read -r _ </run/listens
python3 -c "$5" || echo "it failed"
kill $!
"""
MUSEUM = """
import selectors, socket
listeners = [socket.create_server(("10.9.0.1", port), backlog=2000) for port in (8443, 7403)]
chosen = selectors.DefaultSelector()
for one in listeners: chosen.register(one, selectors.EVENT_READ)
print("ready", flush=True)
kept = []
while True:
    for key, _ in chosen.select(): kept.append(key.fileobj.accept())
"""
OUTSIDE = """
import socket
def enters(host, port, timeout=5):
    client = socket.socket()
    client.settimeout(timeout)
    client.bind((host, 0))
    try:
        client.connect(("10.9.0.1", port))
        return True
    except OSError:
        return False
print("page:", enters("10.9.0.3", 8443))
flood = [socket.socket() for _ in range(900)]
for one in flood:
    one.setblocking(False)
    one.bind(("10.9.0.2", 0))
    one.connect_ex(("10.9.0.1", 8443))
# A lost first packet is sent again after a second.
print("page beside a flood:", enters("10.9.0.3", 8443, 0.5))
print("tour:", enters("10.9.0.3", 7403, 0.5))
"""
SERVERS = """
import socket, time
kept = [socket.create_server(("10.9.0.2", port)) for port in (22, 80, 443, 465, 587)]
print("ready", flush=True)
time.sleep(60)
"""
# The page's user is root here.
INSIDE = """
import socket
for port in (22, 80, 443, 465, 587):
    client = socket.socket()
    client.settimeout(2)
    try:
        client.connect(("10.9.0.2", port))
        print(f"out to {port}: True")
    except OSError:
        print(f"out to {port}: False")
"""
WANTED = ("page: True\npage beside a flood: True\ntour: False\nout to 22: False\nout to 80: False\nout to 443: True\n"
          "out to 465: True\nout to 587: True\n")


def main(source):
    if os.geteuid() != 0 or not shutil.which("nft") or not shutil.which("ip"):
        print("filter: skipped, it needs root, nft (package nftables) and ip (package iproute2)")
        return SKIPPED
    rules = (pathlib.Path(source) / "kiosk/lockdown/etc/nftables.conf").read_text()
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "rules"
        # The users exist in the image alone.
        file.write_text(re.sub(r"meta skuid (\{[^}]*\}|\S+)", "meta skuid 0", rules))
        done = subprocess.run(["unshare", "--net", "--mount", "bash", "-c", ROOM, "room", file, MUSEUM, OUTSIDE,
                               SERVERS, INSIDE],
                              capture_output=True, text=True, timeout=60)
    if done.stdout != WANTED:
        print(f"filter: wanted\n{WANTED}but got\n{done.stdout}{done.stderr}")
        return 1
    print("filter: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
