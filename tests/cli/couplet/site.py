# SPDX-License-Identifier: Apache-2.0
"""The site: no dead link, nothing from elsewhere, all cases in the gallery, served on the loopback address alone, and searched in a headless
browser without an error. Usage: site.py BIN"""
import html.parser
import json
import pathlib
import re
import shutil
import sys
import tempfile
import time
import urllib.parse
import urllib.request

from browser import browser, errors, hosts, listening
from scene import ROOT, call, environment, start
from checks import check, end  # noqa: E402
from couplet.documents.site import nav_of, pages  # noqa: E402

bin_ = pathlib.Path(sys.argv[1])
if not shutil.which("mkdocs"):
    print("skipped: no mkdocs here (Debian: mkdocs-material)")
    sys.exit(77)


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.ids |= {attributes[k] for k in ("id", "name") if attributes.get(k)}
        self.links += [(tag, attributes[k]) for k in ("href", "src") if attributes.get(k)]


def dead_links(site):
    pages = {f.resolve(): Page(f.read_text()) for f in site.rglob("*.html")}
    dead, foreign = [], []
    for file, page in pages.items():
        for tag, link in page.links if file.name != "404.html" else ():
            address = urllib.parse.urlparse(link)
            if address.scheme or address.netloc:
                foreign += [link] if tag != "a" else []
                continue
            target = (file.parent / urllib.parse.unquote(address.path)).resolve() if address.path else file
            target = target / "index.html" if target.is_dir() else target
            if not target.exists() or address.fragment and target in pages and urllib.parse.unquote(address.fragment) not in pages[target].ids:
                dead.append(f"{file.relative_to(site.resolve())}: {link}")
    return len(pages), dead, foreign


with tempfile.TemporaryDirectory(prefix="couplet-site-") as scratch:
    site = pathlib.Path(scratch) / "site"
    built = call(bin_, "docs", "--build", site)
    check("the site is built without a warning", built.returncode == 0 and "WARNING" not in built.stderr, built.stdout + built.stderr)
    count, dead, foreign = dead_links(site)
    check(f"{count} pages, no dead link", count > 100 and not dead, "\n".join(dead))
    check("nothing is loaded from elsewhere", not foreign, foreign)
    text = (site / "gallery.html").read_text()
    missing = [f.parent.name for f in ROOT.glob("configs/*/case.yaml") if f"couplet run configs/{f.parent.name}<" not in text]
    check("the gallery has all cases", not missing, missing)
    found = {entry["location"].partition("#")[0] for entry in json.loads((site / "search/search_index.json").read_text())["docs"]}
    check("the search knows the keys", {"docs/config.html", "docs/keys/fluid_solver.html"} <= found, sorted(found)[:3])
    wanted = {"docs/limitations.html", "docs/how-to/restart.html", "docs/how-to/index.html", "configs/cavity/index.html", "gallery.html"}
    check("the search knows what users read", wanted <= found, wanted - found)
    unwanted = [name for name in found if name.startswith(("common/", "tests/", "docs/validation/", "CONTRIBUTING"))]
    check("the search leaves out what is for developers", not unwanted, unwanted)
    nav = nav_of(pages())
    sections = re.findall(r"^ {2}- ([^:]+):", nav, flags=re.M)
    check("the sidebar has four kinds", sections == ["Couplet", "All pages", "Tutorials", "How-to", "Reference", "Explanation", "Gallery", "For developers"], sections)
    missing = {"index.md" if str(p) == "README.md" else str(p) for p in pages()} ^ set(re.findall(r": (\S+\.md)$", nav, flags=re.M))
    check("every page is in the sidebar", not missing, missing)

    server = start(bin_, "docs", "--port", "0", env={**environment(bin_), "XDG_CACHE_HOME": scratch, "PYTHONUNBUFFERED": "1"})
    address = None
    while not address and (line := server.stdout.readline()):
        address = (re.search(r"http://127.0.0.1:\d+/", line) or [None])[0]
    try:
        check("couplet docs serves it", b"scripts/demo" in urllib.request.urlopen(address).read(), address)
        check("on the loopback address alone", set(listening(server.pid)) == {"0100007F"}, listening(server.pid))
        with browser() as driver:
            if driver:
                from selenium.webdriver.common.by import By
                for page in ("", "gallery.html", "docs/config.html", "configs/cavity/index.html"):
                    driver.get(address + page)
                    check(f"no error on the console: {page or 'index.html'}", not errors(driver) and driver.title.endswith("Couplet"), driver.title)
                for page in (p for p in sorted(site.rglob("*.html")) if 'class="arithmatex"' in p.read_text()):
                    driver.get(f"{address}{page.relative_to(site)}")
                    count = "const all = [...document.querySelectorAll('.arithmatex')]; return [all.length, all.filter(e => e.querySelector('.mjx-chtml')).length]"
                    limit = time.monotonic() + 30
                    while len(set(driver.execute_script(count))) > 1 and time.monotonic() < limit:
                        time.sleep(0.2)
                    there, set_ = driver.execute_script(count)
                    check(f"all {there} formulas of {page.name} are set", there > 0 and there == set_ and not errors(driver) and not driver.find_elements(By.CSS_SELECTOR, ".merror"), set_)
                driver.get(address)
                field = driver.find_element(By.CSS_SELECTOR, "input[data-md-component=search-query]")
                driver.execute_script("arguments[0].focus(); arguments[0].value = 'hang-timeout'; arguments[0].dispatchEvent(new Event('keyup', {bubbles: true}));", field)
                limit = time.monotonic() + 20
                found = []
                while not found and time.monotonic() < limit:
                    time.sleep(0.2)
                    found = [e.get_attribute("href") for e in driver.find_elements(By.CSS_SELECTOR, ".md-search-result__link")]
                check("the search finds a key", any("config" in (h or "") for h in found), found)
                check("nobody else was asked for anything", hosts(driver) == {"127.0.0.1"} and not errors(driver), (hosts(driver), errors(driver)))
            else:
                print("no browser here: pages were not opened")
    finally:
        server.terminate()
        server.wait()
end()
