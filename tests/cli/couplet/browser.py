# SPDX-License-Identifier: Apache-2.0
"""A headless browser for the tests; None where there is none."""
import contextlib
import shutil


@contextlib.contextmanager
def browser():
    """Yields a driver of selenium, or None (Debian: chromium, chromium-driver, python3-selenium)."""
    try:
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
    except ImportError:
        yield None
        return
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        yield None
        return
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1280,900"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    try:
        yield driver
    finally:
        driver.quit()


def errors(driver):
    """What the console complains of."""
    return [entry["message"] for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "ERROR")]


def hosts(driver):
    """Whom the page that is shown asked for anything."""
    import urllib.parse
    names = driver.execute_script("return performance.getEntries().map(e => e.name)")
    return {urllib.parse.urlparse(name).hostname for name in names if name.startswith("http")}


def listening(pid):
    """Addresses that a process listens on, as /proc/net/tcp has them: 0100007F is 127.0.0.1."""
    import os
    import pathlib
    sockets = set()
    for file in os.scandir(f"/proc/{pid}/fd"):
        with contextlib.suppress(OSError):
            sockets.add(os.readlink(file.path))
    found = []
    for table in ("tcp", "tcp6"):
        for line in pathlib.Path(f"/proc/{pid}/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and f"socket:[{fields[9]}]" in sockets:
                found.append(fields[1].split(":")[0])
    return found
