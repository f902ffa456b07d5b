# SPDX-License-Identifier: Apache-2.0
"""One page with the progress of a run, served on the loopback address and protected by a token."""
import http.server
import json
import secrets
import threading
import urllib.parse

PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>couplet watch</title>
<link rel="icon" href="data:,">
<style>body{font:14px sans-serif;margin:1rem;max-width:70rem}canvas{width:32rem;height:14rem;border:1px solid #ccc;margin:.3rem}#status{font:15px monospace}
.warning{color:#a40;margin:.2rem 0}h2{font-size:1rem;margin:.5rem .3rem 0}.plot{display:inline-block}</style>
<h1 id="folder">couplet watch</h1><p id="status">...</p><div id="warnings"></div><div id="plots"></div>
<script>
const token = new URLSearchParams(location.search).get("token");
const colours = ["#1f77b4","#ff7f0e","#2ca02c","#d62728","#9467bd","#8c564b","#e377c2","#7f7f7f"];
function draw(canvas, curve) {
  canvas.width = 640; canvas.height = 280;
  const c = canvas.getContext("2d"), lines = Object.entries(curve.lines);
  const f = v => curve.log ? Math.log10(Math.abs(v)) : v;
  const all = lines.flatMap(([, p]) => p.filter(q => q[1] !== null && (!curve.log || q[1] != 0)).map(q => [q[0], f(q[1])]));
  if (!all.length) return;
  const xs = all.map(p => p[0]), ys = all.map(p => p[1]);
  const x0 = Math.min(...xs), x1 = Math.max(...xs, x0 + 1e-300), y0 = Math.min(...ys), y1 = Math.max(...ys);
  const X = x => 60 + 560 * (x1 > x0 ? (x - x0) / (x1 - x0) : 0.5), Y = y => 250 - 230 * (y1 > y0 ? (y - y0) / (y1 - y0) : 0.5);
  c.font = "11px sans-serif"; c.fillStyle = "#333";
  const shown = y => curve.log ? "1e" + y.toFixed(1) : y.toPrecision(3);
  c.fillText(shown(y1), 4, 24); c.fillText(shown(y0), 4, 252); c.fillText(x0.toPrecision(4), 60, 272); c.fillText(x1.toPrecision(4) + "  " + curve.x, 520, 272);
  lines.forEach(([name, points], i) => {
    c.strokeStyle = c.fillStyle = colours[i % 8]; c.beginPath();
    let open = false;
    for (const [x, v] of points) { if (v === null || curve.log && v == 0) { open = false; continue; } open ? c.lineTo(X(x), Y(f(v))) : c.moveTo(X(x), Y(f(v))); open = true; }
    c.stroke(); c.fillText(name, 70, 24 + 13 * i);
  });
}
async function look() {
  try {
    const state = await (await fetch("state?token=" + encodeURIComponent(token))).json();
    document.getElementById("folder").textContent = state.folder;
    document.getElementById("status").textContent = (state.running ? "" : "ended: ") + state.status;
    const warnings = document.getElementById("warnings"); warnings.replaceChildren();
    for (const text of state.warnings) { const p = document.createElement("p"); p.className = "warning"; p.textContent = text; warnings.append(p); }
    const plots = document.getElementById("plots");
    state.curves.forEach((curve, i) => {
      if (!plots.children[i]) { const d = document.createElement("div"); d.className = "plot"; d.append(document.createElement("h2"), document.createElement("canvas")); plots.append(d); }
      plots.children[i].children[0].textContent = curve.title; draw(plots.children[i].children[1], curve);
    });
  } catch (e) { document.getElementById("status").textContent = "couplet watch has ended"; return; }
  setTimeout(look, 1000);
}
look();
</script></html>
"""


def handler_of(progress, token):
    lock = threading.Lock()

    class Handler(http.server.BaseHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def answer(self, code, kind, text):
            data = text.encode()
            self.send_response(code)
            for head, value in (("Content-Type", f"{kind}; charset=utf-8"), ("Content-Length", str(len(data))), ("Cache-Control", "no-store"), ("Referrer-Policy", "no-referrer"),
                                ("Content-Security-Policy", "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:")):
                self.send_header(head, value)
            self.end_headers()
            self.wfile.write(data)

        def do_GET(self):
            address = urllib.parse.urlparse(self.path)
            given = urllib.parse.parse_qs(address.query).get("token", [""])[0]
            # A request with another host name comes from a foreign page that tries to read this one.
            mine = self.headers.get("Host", "") == f"127.0.0.1:{self.server.server_port}"
            if not mine or not secrets.compare_digest(given.encode(), token.encode()):
                self.answer(403, "text/plain", "The token is missing or wrong: use the address printed by couplet watch.\n")
            elif address.path == "/":
                self.answer(200, "text/html", PAGE)
            elif address.path == "/state":
                with lock:
                    self.answer(200, "application/json", json.dumps(progress.state()))
            else:
                self.answer(404, "text/plain", "There is nothing here.\n")

    return Handler


def server(progress, port=0):
    """Returns (server, address with its token), only on the loopback address."""
    token = secrets.token_urlsafe(18)
    made = http.server.ThreadingHTTPServer(("127.0.0.1", port), handler_of(progress, token))
    return made, f"http://127.0.0.1:{made.server_port}/?token={token}"
