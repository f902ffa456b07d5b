# SPDX-License-Identifier: Apache-2.0
"""One page with the progress of a run, served on the loopback address and protected by a token."""
import http.server
import json
import pathlib
import secrets
import sys
import threading
import urllib.parse

PAGE = (pathlib.Path(__file__).parent / "page.html").read_text()


def handler_of(progress, token):
    lock = threading.Lock()

    class Handler(http.server.BaseHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def answer(self, code, kind, text):
            data = text.encode()
            self.send_response(code)
            for head, value in (
                ("Content-Type", f"{kind}; charset=utf-8"),
                ("Content-Length", str(len(data))),
                ("Cache-Control", "no-store"),
                ("Referrer-Policy", "no-referrer"),
                (
                    "Content-Security-Policy",
                    (
                        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self';"
                        " img-src data:"
                    ),
                ),
            ):
                self.send_header(head, value)
            self.end_headers()
            self.wfile.write(data)

        def do_GET(self):
            try:
                address = urllib.parse.urlparse(self.path)
            except ValueError:
                return self.answer(400, "text/plain", "There is no such page.\n")
            given = urllib.parse.parse_qs(address.query).get("token", [""])[0]
            # A request with another host name comes from a foreign page that tries to read this one.
            mine = self.headers.get("Host", "") == f"127.0.0.1:{self.server.server_port}"
            if not mine or not secrets.compare_digest(given.encode(), token.encode()):
                self.answer(
                    403, "text/plain", "The token is missing or wrong: use the address printed by couplet watch.\n"
                )
            elif address.path == "/":
                self.answer(200, "text/html", PAGE)
            elif address.path == "/state":
                with lock:
                    self.answer(200, "application/json", json.dumps(progress.state()))
            else:
                self.answer(404, "text/plain", "There is nothing here.\n")

    return Handler


class Server(http.server.ThreadingHTTPServer):
    """Says nothing about a client that leaves before it has its answer."""

    def handle_error(self, request, client_address):
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)


def server(progress, port=0):
    """Returns (server, address with its token), only on the loopback address."""
    token = secrets.token_urlsafe(18)
    made = Server(("127.0.0.1", port), handler_of(progress, token))
    return made, f"http://127.0.0.1:{made.server_port}/?token={token}"
