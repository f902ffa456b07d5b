# SPDX-License-Identifier: Apache-2.0
"""couplet watch --web during a run: values change, a wrong token and another host's name are refused, nothing listens beyond the loopback address, and
a headless browser shows it without an error. Usage: web.py BIN"""
import http.client
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.parse
import urllib.request

from browser import browser, errors, hosts, listening
from scene import case_in, environment, start
from checks import check, end  # noqa: E402

bin_ = pathlib.Path(sys.argv[1])


def code_of(address, host=None):
    parts = urllib.parse.urlparse(address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=10)
    connection.request("GET", f"{parts.path}?{parts.query}", headers={"Host": host} if host else {})
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


with tempfile.TemporaryDirectory(prefix="couplet-web-") as scratch:
    folder = pathlib.Path(scratch)
    case = case_in(folder / "a", bin_, end_time=100, checkpoints=10)
    job = start(bin_, "run", case, stdout=subprocess.DEVNULL)
    limit = time.monotonic() + 60
    while not (folder / "a/out/solid/steps.csv").exists() and time.monotonic() < limit:
        time.sleep(0.05)
    watch = start(bin_, "watch", folder / "a/out", "--web", env={**environment(bin_), "PYTHONUNBUFFERED": "1"})
    try:
        address = re.match(r"(http://127\.0\.0\.1:\d+/\?token=\S+)", watch.stdout.readline())[1]
        state = address.replace("/?", "/state?")
        first = json.loads(code_of(state)[1])
        time.sleep(2)
        second = json.loads(code_of(state)[1])
        check("values change while it runs", first["running"] and second["running"] and second["status"] != first["status"] and "to go" in second["status"], (first["status"], second["status"]))
        titles = [c["title"] for c in second["curves"]]
        check("curves of residuals, step size and probes", {"residuals of the coupling", "step size of solid", "probes of solid"} <= set(titles), titles)
        for what, wrong in (("wrong", re.sub("token=.", "token=!", address)), ("missing", address.partition("?")[0]), ("empty", re.sub("token=.*", "token=", address))):
            check(f"a {what} token is refused", code_of(wrong)[0] == 403 and code_of(wrong.replace("/?", "/state?"))[0] == 403, wrong)
        check("another name for this host is refused", code_of(address, host="evil.example")[0] == 403)
        check("nothing else is served", code_of(address.replace("/?", "/../../etc/passwd?"))[0] == 404)
        check("nothing listens beyond the loopback address", set(listening(watch.pid)) == {"0100007F"}, listening(watch.pid))
        with browser() as driver:
            if driver:
                from selenium.webdriver.common.by import By
                driver.get(address)
                time.sleep(2.5)
                before = driver.find_element(By.ID, "status").text
                time.sleep(2)
                after = driver.find_element(By.ID, "status").text
                canvases = driver.find_elements(By.TAG_NAME, "canvas")
                check("the page renews itself", before != after and "step" in after and len(canvases) >= 3, (before, after))
                drawn = driver.execute_script("const c = document.querySelector('canvas'); return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some(v => v)")
                check("curves are drawn, without an error, and from this host alone", drawn and not errors(driver) and hosts(driver) == {"127.0.0.1"}, errors(driver))
            else:
                print("no browser here: the page was not opened")
    finally:
        watch.terminate()
        job.terminate()
        job.communicate(timeout=60)
        watch.communicate(timeout=60)
end()
