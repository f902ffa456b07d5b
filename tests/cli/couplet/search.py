# SPDX-License-Identifier: Apache-2.0
"""Bars of `scripts/validate newcomer` for the site. Usage: search.py PART; parts: pages (number and length of the pages for users),
search (the page that each word must find among its first three hits, in a headless browser)"""
import functools
import http.server
import pathlib
import sys
import tempfile
import threading
import time
import urllib.parse

from browser import browser
from scene import ROOT
from checks import check, end  # noqa: E402
from couplet.documents import site  # noqa: E402

RIGHT = {"plasticity": ("docs/limitations.html",), "limitations": ("docs/limitations.html",), "ubuntu": ("docs/how-to/build-elsewhere.html",),
         "restart": ("docs/how-to/restart.html",), "boundary conditions": ("docs/how-to/boundary-conditions.html",),
         "drag": ("docs/how-to/drag-and-lift.html",), "modes": ("docs/how-to/modes.html",), "cluster": ("docs/how-to/cluster.html",),
         "units": ("docs/quantities.html",), "license": ("index.html",)}
MOST_PAGES, MOST_WORDS = 80, 3000


def pages():
    hand_written = [p for p in site.pages() if site.is_for_users(p) and not site.is_generated(p)]
    words = {str(p): len((ROOT / p).read_text().split()) for p in hand_written if str(p) != "CHANGELOG.md"}  # release notes grow with the releases
    check(f"{len(words)} pages for users, at most {MOST_PAGES}", 40 < len(words) <= MOST_PAGES, len(words))
    longest = max(words, key=words.get)
    check(f"the longest is {longest} with {words[longest]} words, at most {MOST_WORDS}", words[longest] <= MOST_WORDS, words[longest])
    listed = (*site.TUTORIALS, *site.REFERENCE, *site.EXPLANATION, *site.THEORY)
    kinds = {name: listed.count(name) + name.startswith("docs/how-to/") for name in words if name not in ("README.md", "docs/README.md")}
    check("each page is of one kind", set(kinds.values()) == {1}, [name for name, n in kinds.items() if n != 1])


def hits(driver, words, address):
    """Addresses of the pages that a search finds, best first."""
    from selenium.webdriver.common.by import By
    for _ in range(3):  # a query that comes before the index is there may be lost
        driver.get(f"{address}?q={urllib.parse.quote(words)}")
        limit = time.monotonic() + 30
        while time.monotonic() < limit:
            time.sleep(0.2)
            if found := driver.find_elements(By.CSS_SELECTOR, ".md-search-result__item > a.md-search-result__link"):
                return [link.get_attribute("href").partition("?")[0].removeprefix(address) for link in found]
    return []


def search():
    with tempfile.TemporaryDirectory(prefix="couplet-site-") as scratch, browser() as driver:
        if not driver:
            print("skipped: no browser here (Debian: chromium, chromium-driver, python3-selenium)")
            sys.exit(77)
        site.build(scratch)
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=scratch))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        for words, right in RIGHT.items():
            found = hits(driver, words, f"http://127.0.0.1:{server.server_address[1]}/")[:3]
            check(f"'{words}' finds {' or '.join(right)} among the first three", any((page or "index.html") in right for page in found), found)
        server.shutdown()


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


{"pages": pages, "search": search}[sys.argv[1]]()
end()
