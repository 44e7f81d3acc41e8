# SPDX-License-Identifier: Apache-2.0
"""A mail server for tests: aiosmtpd (Debian's python3-aiosmtpd) with STARTTLS and a login.

Run by /usr/bin/python3: mail_server.py PORT FOLDER CERTIFICATE KEY PASSWORD. Each message becomes FOLDER/N.eml, with its
receivers in the header X-Receivers. It prints "ready".
"""
import pathlib
import ssl
import sys
import time

from aiosmtpd.controller import Controller
from aiosmtpd.smtp import AuthResult


class Mailbox:
    def __init__(self, folder):
        self.folder, self.count = pathlib.Path(folder), 0

    async def handle_DATA(self, _server, _session, envelope):
        self.count += 1
        receivers = f"X-Receivers: {','.join(envelope.rcpt_tos)}\r\n".encode()
        part = self.folder / f"{self.count}.part"
        part.write_bytes(receivers + envelope.content)
        part.rename(self.folder / f"{self.count}.eml")
        return "250 kept"


def main(port, folder, certificate, key, password):
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)

    def admit(_server, _session, _envelope, _mechanism, data):
        return AuthResult(success=(data.login, data.password) == (b"wall", password.encode()), handled=False)

    controller = Controller(Mailbox(folder), hostname="::1", port=int(port), tls_context=context, require_starttls=True,
                            auth_required=True, authenticator=admit)
    controller.start()
    print("ready", flush=True)
    while True:
        time.sleep(3600)


if __name__ == "__main__":
    main(*sys.argv[1:])
