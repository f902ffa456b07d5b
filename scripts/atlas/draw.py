# SPDX-License-Identifier: Apache-2.0
"""A map as a picture."""
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Patch

import atlas

COLORS = {
    atlas.HOLDS: "#7cc67c",
    atlas.POOR: "#cfe8a9",
    atlas.WARNED: "#f6c75c",
    atlas.REFUSED: "#a9b8d6",
    atlas.RED: "#e0453a",
}

WIDEST_X, WIDEST_Y = 34, 26  # characters of a label's line beside a panel


def place(values, at, log):
    """Returns the position of a value on the scale of the squares' indices."""
    f = np.log(values) if log else np.asarray(values, float)
    v = np.log(at) if log else np.asarray(at, float)
    order = np.argsort(f)
    return np.interp(v, f[order], np.arange(len(values))[order], left=np.nan, right=np.nan)


def picture(map_, squares, file):
    xs, ys = map_.x["values"], map_.y["values"]
    n = len(map_.panels)
    columns = min(n, 2 if n == 4 else 3)  # four beside each other are too small to read on a page
    lines = -(-n // columns)
    figure, axes = plt.subplots(
        lines,
        columns,
        squeeze=False,
        dpi=110,
        constrained_layout=True,
        figsize=(1.2 + columns * max(2.6, 0.62 * len(xs)), 1.2 + lines * max(2.0, 0.46 * len(ys))),
    )
    for ax, panel in zip(axes.flat, map_.panels):
        for j, y in enumerate(ys):
            for i, x in enumerate(xs):
                s = squares[panel, float(x), float(y)]
                ax.add_patch(plt.Rectangle((i - 0.5, j - 0.5), 1, 1, color=COLORS[s.outcome], lw=0))
                text = f"{s.number:.2g}" if np.isfinite(s.number) and s.code == 0 else ("" if s.code == 0 else "stop")
                ax.text(i, j, text, ha="center", va="center", fontsize=6.5)
        for panels, label, us, vs in map_.theory():
            if panels is not None and panel not in panels:
                continue
            cx = place(xs, us, map_.x["log"])
            cy = place(ys, vs, map_.y["log"])
            ax.plot(cx, cy, "k--", lw=1.5, label=label)
            ax.legend(fontsize=6.5, loc="upper left")
        ax.set(
            xlim=(-0.5, len(xs) - 0.5),
            ylim=(-0.5, len(ys) - 0.5),
            xticks=range(len(xs)),
            yticks=range(len(ys)),
            xticklabels=[f"{x:g}" for x in xs],
            yticklabels=[f"{y:g}" for y in ys],
            title=panel,
        )
        ax.tick_params(labelsize=7)
        ax.set_xlabel(textwrap.fill(map_.x["label"], WIDEST_X), fontsize=8)
        ax.set_ylabel(textwrap.fill(map_.y["label"], WIDEST_Y), fontsize=8)
        ax.title.set_fontsize(9)
    for ax in list(axes.flat)[n:]:
        ax.axis("off")
    there = {s.outcome for s in squares.values()}
    figure.legend(
        handles=[Patch(color=c, label=o) for o, c in COLORS.items() if o in there],
        loc="lower center",
        ncol=5,
        fontsize=7.5,
    )
    figure.get_layout_engine().set(rect=(0, 0.26 / figure.get_figheight(), 1, 1 - 0.26 / figure.get_figheight()))
    figure.suptitle(f"{map_.title}: {map_.criterion}", fontsize=9.5)
    figure.savefig(file)
    plt.close(figure)
