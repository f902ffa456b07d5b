# SPDX-License-Identifier: Apache-2.0
"""Pictures of a run whose case declares none: the flow, the deformed body, temperatures and shapes."""
import functools
import pathlib

import numpy as np

from couplet import fields
from couplet.runs.case import Wrong
from couplet.series import find_series


def names_of(series):
    """Fields worth a picture: velocity of a flow, stress or else displacement of a body, a temperature that varies."""
    names, last = series.names(-1), len(series.steps) - 1
    varies = [n for n in names if np.ptp(np.asarray(series.field(last, n), float), axis=0).max(initial=0) > 0]
    if "displacement" in names:
        first = next((n for n in ("equivalent-stress", "displacement") if n in varies), None)
    else:
        others = () if "temperature" in names else names
        first = next((n for n in ("velocity", *others) if n in varies), None)
    return [n for n in (first, "temperature") if n in varies]


def middle_of(series):
    """Plane through the middle of a 3-D flow, across its shortest extent. None for others, which are seen from
    outside."""
    if series.is_flat() or "displacement" in series.names(-1):
        return None
    points = series.reference()
    low, high = points.min(axis=0), points.max(axis=0)
    size = high - low
    axis = max(k for k in range(3) if size[k] <= 1.001 * size.min())
    return f"{'xyz'[axis]} = {0.5 * (low + high)[axis]:.4g}"


def tasks(folder, options):
    """Functions that draw and name the pictures of a run in this folder, or of its participant."""
    return [functools.partial(draw, p, options) for p in fields.places_below(folder) if any(p.glob("*.h5"))]


def draw(place, options):
    """Draws shapes and fields in a participant's folder. A file that is damaged, or in use by the run, is reported."""
    try:
        for file in filter(pathlib.Path.is_file, (place / name for name in fields.SHAPE_TABLES)):
            print(fields.draw_shapes(file))
        series = find_series(place)
        if not series.steps or pathlib.Path(series.file.filename).name in fields.SHAPE_TABLES:
            return
        for name in names_of(series):
            plane = None if series.is_flat() else options.plane or middle_of(series)
            component = options.component if np.ndim(series.field(-1, name)) > 1 else None
            print(fields.draw(place, name, at=options.at, component=component, warp=options.warp, plane=plane))
    except FileNotFoundError:
        return  # other files
    except (OSError, LookupError, ValueError) as problem:
        raise Wrong(f"{place}: fields cannot be drawn: {problem}") from None
