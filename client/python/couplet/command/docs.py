# SPDX-License-Identifier: Apache-2.0
"""Shows the documentation as a site with search and a gallery of all cases. The site is built once and then served on
localhost."""
import functools
import http.server
import os
import pathlib
import sys

from couplet.command.page import Server
from couplet.documents import site


def declare(parser):
    parser.add_argument(
        "--build", type=pathlib.Path, metavar="FOLDER", help="builds the site into this folder and exits"
    )
    parser.add_argument("--port", type=int, default=0, metavar="N", help="port on localhost (default: any free one)")
    parser.add_argument("--again", action="store_true", help="rebuilds the site even if it exists")
    parser.add_argument(
        "--plots",
        action="store_true",
        help="rebuilds the site with the plots of the validation studies and the stability maps, which takes minutes",
    )


def built(arguments):
    """Folder with the site of this version."""
    from couplet.command import version
    from couplet.places import ROOT

    cache = (
        pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache")
        / "couplet"
        / f"site-{version()}-{ROOT.name}"
    )
    newest = max(((ROOT / page).stat().st_mtime for page in site.pages() if (ROOT / page).exists()), default=0)
    mark = cache / "index.html"
    if arguments.again or arguments.plots or not mark.exists() or mark.stat().st_mtime < newest:
        print(f"Building the site ({'minutes' if arguments.plots else 'about 10 s'}) ...", flush=True)
        site.build(cache, arguments.plots)
    return cache


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def send_head(self):
        try:
            return super().send_head()
        except ValueError:  # no address
            self.send_error(400)


def run(arguments):
    if arguments.build:
        for line in site.build(arguments.build, arguments.plots):
            print(line, file=sys.stderr)
        print(f"written: {arguments.build / 'index.html'}")
        return 0
    folder = built(arguments)
    server = Server(("127.0.0.1", arguments.port), functools.partial(Quiet, directory=str(folder)))
    print(f"http://127.0.0.1:{server.server_port}/ (press Ctrl-C to stop)", flush=True)
    server.serve_forever()
    return 0
