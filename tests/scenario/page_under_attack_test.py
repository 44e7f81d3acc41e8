#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the operator page's program under attack, over real TLS sockets: 200 clients that send requests byte by byte
and never finish one do not keep the owner out, and the page feeds its watchdog, for which it must have answered itself.

Run: page_under_attack_test.py BUILD_FOLDER
"""
import os
import pathlib
import queue
import socket
import ssl
import subprocess
import sys
import tempfile
import threading

from farm.processes import free_port

SLOW_CLIENTS = 200
TIMEOUT_S = 30


class Page:
    """cyclorama-operator with a PIN that is never right, and this test in the role of systemd."""

    def __init__(self, build, folder):
        self.state, keep = folder / "state", folder / "keep"
        self.pin_file = self.state / "settings/operator-pin"
        self.pin_file.parent.mkdir(parents=True)
        keep.mkdir()
        self.pin_file.write_text("scrypt:15:8:1:" + "00" * 16 + ":" + "00" * 32)
        self.notified = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.notified.bind(str(folder / "notify"))
        self.messages = queue.Queue()
        threading.Thread(target=self.hear, daemon=True).start()
        self.port = free_port()
        self.program = subprocess.Popen(
            [build / "bin/cyclorama-operator", "--listen", f"[::1]:{self.port}", "--museum", self.state, "--keep", keep,
             "--watch", "tour=[::1]:1"],
            stderr=subprocess.PIPE, text=True,
            env={**os.environ, "NOTIFY_SOCKET": str(folder / "notify"), "WATCHDOG_USEC": "2000000"})
        self.wait_for("READY=1")

    def hear(self):
        # A full socket would block the page, so it is read all the time, as by systemd.
        while True:
            self.messages.put(self.notified.recv(4096).decode())

    def wait_for(self, message):
        while message not in (received := self.messages.get(timeout=TIMEOUT_S)):
            print(f"systemd is notified of {received}")

    def connect(self, timeout=TIMEOUT_S):
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        context.check_hostname = False
        context.verify_mode = ssl.CERT_NONE
        return context.wrap_socket(socket.create_connection(("::1", self.port), timeout=timeout))

    def answer(self, path, timeout=TIMEOUT_S):
        """Returns the first line of an answer; empty if there is none."""
        try:
            with self.connect(timeout) as client:
                client.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
                return client.recv(4096).decode().split("\r\n")[0]
        except OSError:
            return ""

    def end(self):
        self.program.terminate()
        assert self.program.wait(TIMEOUT_S) == 0

    def kill(self):
        self.program.kill()
        self.program.wait()


class SlowClients:
    """Clients that send a byte now and then."""

    def __init__(self):
        self.clients = []
        self.is_over = threading.Event()
        self.thread = threading.Thread(target=self.dribble)
        self.thread.start()

    def dribble(self):
        while not self.is_over.wait(0.5):
            for client in self.clients.copy():
                try:
                    client.send(b"x")
                except OSError:
                    pass  # The page has closed it.

    def add(self, client, first_bytes):
        client.sendall(first_bytes)
        self.clients.append(client)

    def end(self):
        self.is_over.set()
        self.thread.join()
        for client in self.clients:
            client.close()


def check_slow_clients(page):
    slow = SlowClients()
    try:
        for _ in range(SLOW_CLIENTS // 2):
            # The head of a TLS record of 16 KiB with a ClientHello, of which a byte follows now and then.
            client = socket.create_connection(("::1", page.port), timeout=TIMEOUT_S)
            slow.add(client, bytes.fromhex("160301400001003ffc0303"))
        assert page.answer("/login.html") == "HTTP/1.1 200 OK", "slow handshakes keep the owner out"
        for _ in range(SLOW_CLIENTS // 2):
            slow.add(page.connect(), b"POST /login HTTP/1.1\r\nHost: localhost\r\nX-Slow: ")
        assert page.answer("/login.html") == "HTTP/1.1 200 OK", "slow requests keep the owner out"
        page.wait_for("WATCHDOG=1")
    finally:
        slow.end()


def main(build):
    with tempfile.TemporaryDirectory() as folder:
        page = Page(pathlib.Path(build), pathlib.Path(folder))
        try:
            check_slow_clients(page)
            page.end()
        finally:
            page.kill()


if __name__ == "__main__":
    main(*sys.argv[1:])
