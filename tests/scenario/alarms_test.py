#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that alarms reach somebody: a real mail server (STARTTLS, login) and a webhook over TLS get one alarm for a fault
and one when it is over, in the museum's language; a server that is away for a while gets it later, also after a restart;
a wrong password and an unknown certificate are told on the page with a remedy.

Run: alarms_test.py SOURCE_ROOT BUILD_FOLDER      It is skipped (77) without python3-aiosmtpd.
"""
import email
import email.policy
import http.server
import json
import os
import pathlib
import socket
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

from farm.processes import free_port, wait_until

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from museum_room import room_on  # noqa: E402

PIN, PASSWORD, TOKEN = "401773", "mail s3cret", "webhook-s3cret"
SKIPPED = 77
SYSTEM_PYTHON = "/usr/bin/python3"


def certificate(folder, name):
    """Makes a certificate for ::1 and localhost that is its own authority."""
    key, made = folder / f"{name}.key", folder / f"{name}.crt"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days",
                    "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost,IP:::1", "-keyout", str(key),
                    "-out", str(made)], check=True, capture_output=True)
    return made, key


class MailServer:
    def __init__(self, folder, tools, made, key, port):
        self.box = folder / "mail"
        self.box.mkdir(exist_ok=True)
        self.process = subprocess.Popen([SYSTEM_PYTHON, tools / "mail_server.py", str(port), self.box, made, key, PASSWORD],
                                        stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "ready\n", "the mail server did not start"

    def messages(self):
        return [email.message_from_bytes(path.read_bytes(), policy=email.policy.default)
                for path in sorted(self.box.glob("*.eml"), key=lambda path: int(path.stem))]

    def close(self):
        self.process.terminate()
        self.process.wait(30)


class Webhook:
    def __init__(self, made, key):
        self.posts, posts = [], []
        self.posts = posts

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                body = self.rfile.read(int(self.headers["Content-Length"]))
                good = self.headers["Authorization"] == f"Bearer {TOKEN}"
                if good:
                    posts.append(json.loads(body))
                self.send_response(204 if good else 401)
                self.end_headers()

            def log_message(self, *_):
                pass

        class Server(http.server.ThreadingHTTPServer):
            address_family = socket.AF_INET6

        self.server = Server(("::1", 0), Handler)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(made, key)
        self.server.socket = context.wrap_socket(self.server.socket, server_side=True)
        self.url = f"https://localhost:{self.server.server_address[1]}/alarms"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()


class Page:
    """A museum's page and the parts that it watches."""

    def __init__(self, source, build, folder):
        self.build, self.folder = build, folder
        self.stick, self.state, self.keep = folder / "stick", folder / "state", folder / "keep"
        for path in (self.stick, self.keep):
            path.mkdir()
        (self.stick / "site.toml").write_text('[farm]\ncoordinators = ["[::1]:1"]\nmuseum = "Höhle 3"\n')
        (self.stick / "installation.toml").write_text(room_on(source, "HDMI-A"))
        (self.stick / "operator.toml").write_text(f'pin = "{PIN}"\n')
        self.port = free_port()
        self.part_port = free_port()
        self.page = None

    def provision(self):
        return subprocess.run([self.build / "bin/cyclorama-provision", "--state", self.state, "install", self.stick,
                               "--programs", ""], capture_output=True, text=True, timeout=60)

    def start(self):
        self.page = subprocess.Popen([self.build / "bin/cyclorama-operator", "--listen", f"[::1]:{self.port}", "--museum",
                                      self.state, "--keep", self.keep, "--watch", f"tour=[::1]:{self.part_port}"],
                                     stderr=subprocess.PIPE, text=True)
        while "listens on" not in (line := self.page.stderr.readline()):
            assert line, "the page did not start"
        threading.Thread(target=lambda: [None for _ in self.page.stderr], daemon=True).start()
        self.cookie = self.ask("/login", {"pin": PIN})[1]["Set-Cookie"].split(";")[0]

    def ask(self, path, body=None):
        context = ssl._create_unverified_context()
        request = urllib.request.Request(f"https://[::1]:{self.port}{path}",
                                         None if body is None else json.dumps(body).encode(),
                                         {"Content-Type": "application/json", "Accept-Language": "en",
                                          **({"Cookie": self.cookie} if hasattr(self, "cookie") else {})})
        try:
            with urllib.request.urlopen(request, timeout=150, context=context) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def alarms(self):
        return json.loads(self.ask("/museum")[2])["alarms"]

    def stop(self):
        self.page.terminate()
        self.page.wait(30)


class Part:
    """Stands for the tour: while it runs, the part is well."""

    def __init__(self, build, port):
        self.process = subprocess.Popen([build / "bin/test-parts", "--tour-port", str(port)], stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def close(self):
        self.process.terminate()
        self.process.wait(30)


def care(mail_port, webhook, authority, after=10):
    return (f'language = "de"\n[alarms]\nafter_s = {after}\n[alarms.mail]\nserver = "[::1]:{mail_port}"\nuser = "wall"\n'
            f'password_file = "mail-password"\nauthority = "{authority}"\nfrom = "wall@example.org"\n'
            'to = ["technik@example.org", "nacht@example.org"]\n'
            f'[alarms.webhook]\nurl = "{webhook}"\ntoken_file = "webhook-token"\nauthority = "{authority}"\n')


def check(source, build, folder):
    made, key = certificate(folder, "server")
    tools, mail_port = source / "tests/tools", free_port()
    webhook = Webhook(made, key)
    page = Page(source, build, folder)
    (page.stick / "authority.crt").write_bytes(made.read_bytes())
    (page.stick / "care.toml").write_text(care(mail_port, webhook.url, "authority.crt"))
    refused = page.provision()
    assert refused.returncode == 1 and "care.toml [alarms.mail] password_file names" in refused.stderr, refused.stderr
    (page.stick / "mail-password").write_text(PASSWORD + "\n")
    (page.stick / "webhook-token").write_text(TOKEN + "\n")
    done = page.provision()
    assert done.returncode == 0, done.stderr
    page.start()

    # The mail server is away at first: the webhook gets its alarm, and the page says what is wrong with the mail.
    wait_until(lambda: len(webhook.posts) == 1, 60, "the alarm by the webhook")
    begun = webhook.posts[0]
    assert begun["museum"] == "Höhle 3" and begun["alarms"][0]["state"] == "begun", begun
    faults = {alarm["id"] for alarm in begun["alarms"]}
    assert "part-tour" in faults and "Rundgang" in json.dumps(begun, ensure_ascii=False), begun
    wait_until(lambda: "cannot be reached" in page.alarms()["problem"], 60, "the trouble with the mail server")
    page.stop()
    server = MailServer(folder, tools, made, key, mail_port)
    page.start()
    wait_until(lambda: len(server.messages()) == 1, 90, "the alarm by mail, after a restart")
    message = server.messages()[0]
    assert message["X-Receivers"] == "technik@example.org,nacht@example.org", message["X-Receivers"]
    assert message["From"].addresses[0].display_name == "Höhle 3", message["From"]
    assert "Höhle 3: Fehler: " in message["Subject"], message["Subject"]
    assert "Warten Sie eine Minute" in message.get_content(), message.get_content()
    assert len(webhook.posts) == 1, "the webhook got it twice"

    # The fault is over: one message each.
    part = Part(build, page.part_port)
    wait_until(lambda: len(server.messages()) == 2 and len(webhook.posts) == 2, 90, "the end of the fault")
    assert {alarm["id"]: alarm["state"] for alarm in webhook.posts[1]["alarms"]}["part-tour"] == "over", webhook.posts[1]
    assert "Vorbei: Rundgang" in server.messages()[1]["Subject"], server.messages()[1]["Subject"]
    time.sleep(15)
    assert len(server.messages()) == 2 and len(webhook.posts) == 2, "an alarm came again"

    # A test from the page; a wrong password and an unknown certificate are told with a remedy.
    assert page.ask("/alarm-test", {})[0] == 204
    assert len(server.messages()) == 3 and len(webhook.posts) == 3
    (page.state / "settings/mail-password").chmod(0o600)
    for change, words in ((lambda: (page.stick / "mail-password").write_text("wrong\n"), "refuses the login"),
                          (lambda: (page.stick / "authority.crt").write_bytes(certificate(folder, "other")[0].read_bytes()),
                           "is not trusted")):
        change()
        done = page.provision()
        assert done.returncode == 0, done.stderr
        code, _, body = page.ask("/alarm-test", {})
        assert code in (400, 502) and words in json.loads(body)["error"] and "care.toml" in json.loads(body)["error"], body
    assert len(server.messages()) == 3
    part.close()
    page.stop()
    server.close()


def main(source, build):
    if subprocess.run([SYSTEM_PYTHON, "-c", "import aiosmtpd"], capture_output=True).returncode != 0:
        print("alarms: skipped, python3-aiosmtpd is not installed; scripts/install-packages test installs it")
        return SKIPPED
    os.environ.pop("http_proxy", None)
    with tempfile.TemporaryDirectory() as folder:
        check(pathlib.Path(source), pathlib.Path(build), pathlib.Path(folder))
    print("alarms: ok")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
