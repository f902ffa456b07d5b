# SPDX-License-Identifier: Apache-2.0
"""Report of a study: Markdown beside its pictures, and one self-contained HTML page."""
import base64
import html
import pathlib
import re

from couplet import files

STYLE = (pathlib.Path(__file__).parent / "report.css").read_text().strip()


def number(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


class Report:
    """Blocks in order: ("text", sentence), ("head", text), ("table", head, rows), ("picture", file, caption)."""

    def __init__(self, title):
        self.title, self.blocks = title, []

    def text(self, sentence):
        self.blocks.append(("text", sentence))

    def head(self, text):
        self.blocks.append(("head", text))

    def table(self, head, rows):
        self.blocks.append(("table", head, [[number(c) for c in row] for row in rows]))

    def picture(self, file, caption):
        if file:
            self.blocks.append(("picture", pathlib.Path(file), caption))

    def markdown(self, folder):
        lines = [f"# {self.title}", ""]
        for kind, *what in self.blocks:
            if kind == "text":
                lines += [what[0], ""]
            elif kind == "head":
                lines += [f"## {what[0]}", ""]
            elif kind == "table":
                head, rows = what
                escaped = [[str(c).replace("|", "\\|") for c in row] for row in (head, *rows)]
                lines += [
                    "| " + " | ".join(escaped[0]) + " |",
                    "|" + "---|" * len(head),
                    *("| " + " | ".join(r) + " |" for r in escaped[1:]),
                    "",
                ]
            else:
                lines += [f"![{what[1]}]({what[0].resolve().relative_to(pathlib.Path(folder).resolve())})", ""]
        return "\n".join(lines).rstrip() + "\n"

    def html(self):
        def inline(text):
            text = re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(text, quote=False))
            return re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", text)

        parts = [
            "<!doctype html><html lang=en><head><meta charset=utf-8><meta name=viewport"
            " content='width=device-width,initial-scale=1'>"
            f"<title>{html.escape(self.title)}</title><style>{STYLE}</style></head>"
            f"<body><h1>{html.escape(self.title)}</h1>"
        ]
        for kind, *what in self.blocks:
            if kind == "text":
                parts.append(f"<p>{inline(what[0])}</p>")
            elif kind == "head":
                parts.append(f"<h2>{inline(what[0])}</h2>")
            elif kind == "table":
                head, rows = what
                parts.append(
                    "<table><thead><tr>"
                    + "".join(f"<th>{inline(str(c))}</th>" for c in head)
                    + "</tr></thead><tbody>"
                    + "".join("<tr>" + "".join(f"<td>{inline(c)}</td>" for c in row) + "</tr>" for row in rows)
                    + "</tbody></table>"
                )
            else:
                data = base64.b64encode(what[0].read_bytes()).decode()
                parts.append(
                    f"<figure><img alt=\"{html.escape(what[1])}\""
                    f" src=\"data:image/png;base64,{data}\"><figcaption>{inline(what[1])}</figcaption></figure>"
                )
        return "\n".join([*parts, "</body></html>\n"])

    def write(self, folder, stem="report"):
        files.write(folder, f"{stem}.md", self.markdown(pathlib.Path(folder)))
        return files.write(folder, f"{stem}.html", self.html())
