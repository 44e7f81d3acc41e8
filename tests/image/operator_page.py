# SPDX-License-Identifier: Apache-2.0
"""A client of the operator page in the museum's network: HTTPS with the page's own certificate, and a PIN."""
import hashlib
import http.client
import io
import json
import ssl
import zipfile

ANSWERS_WITHIN_S = 60


class OperatorPage:
    """No method raises if the page does not answer (yet): results are then None or empty."""

    def __init__(self, port, pin):
        self._port, self._pin = port, pin
        self._cookie = None
        self._trust = ssl.create_default_context()
        self._trust.check_hostname = False
        self._trust.verify_mode = ssl.CERT_NONE
        self.certificate = ""  # The fingerprint in the form that browsers show.

    def _once(self, method, path, body, cookie):
        connection = http.client.HTTPSConnection("127.0.0.1", self._port, timeout=ANSWERS_WITHIN_S, context=self._trust)
        try:
            headers = {"Cookie": cookie} if cookie else {}
            if body is not None:
                headers["Content-Type"] = "application/json"
            connection.request(method, path, body, headers)
            self.certificate = ":".join(f"{byte:02X}"
                                        for byte in hashlib.sha256(connection.sock.getpeercert(binary_form=True)).digest())
            answer = connection.getresponse()
            return answer.status, answer.getheader("Set-Cookie"), answer.read()
        except (OSError, http.client.HTTPException):
            return None, None, b""
        finally:
            connection.close()

    def without_pin(self, path):
        """Returns the HTTP status that a client without the PIN gets."""
        return self._once("GET", path, None, None)[0]

    def ask(self, method, path, body=None):
        """Returns the answer to a request after entering the PIN, or None."""
        for _ in range(2):
            if self._cookie is None:
                status, cookie, _ = self._once("POST", "/login", json.dumps({"pin": self._pin}), None)
                if status != 204:
                    return None
                self._cookie = cookie.split(";")[0]
            status, _, answer = self._once(method, path, body, self._cookie)
            if status != 401:
                return answer if status in (200, 204) else None
            self._cookie = None  # The page was restarted.
        return None

    def _json(self, path):
        answer = self.ask("GET", path)
        return json.loads(answer) if answer else {}

    def museum(self):
        return self._json("/museum")

    def check(self, name):
        """Returns (level, sentence) of one check, such as "part-tracker"."""
        for line in self.museum().get("checks", []):
            if line["id"] == name:
                return line["level"], line["sentence"]
        return None, ""

    def process(self, name):
        return next((one for one in self._json("/status").get("processes", []) if one["name"] == name), {})

    def state(self, name):
        """Returns a part's state, a sentence."""
        return self.process(name).get("state", "")

    def support_bundle(self):
        """Returns {file: text}."""
        answer = self.ask("GET", "/support-bundle.zip")
        if not answer:
            return {}
        with zipfile.ZipFile(io.BytesIO(answer)) as archive:
            return {name: archive.read(name).decode(errors="replace") for name in archive.namelist()}
