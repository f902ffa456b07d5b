#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Follows the XDMF index by hand (xml + h5py): every reference leads to a table of the size it says, the times are all
there, and the points of each time are the moved ones. Usage: PROGRAM RANKS FOLDER"""
import sys
import xml.etree.ElementTree as xml

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

import run_sample

WIDTH = {4: 3, 5: 4, 6: 4, 7: 5, 8: 6, 9: 8}


def table(folder, item):
    file, path = item.text.strip().split(":")
    with h5py.File(folder / file, "r") as f:
        values = f[path][...]
    wanted = tuple(int(n) for n in item.get("Dimensions").split())
    assert values.shape == wanted, f"{path}: index says {wanted}, file has {values.shape}"
    return values


def check_mixed(flat, n_cells, n_points):
    at = cells = 0
    while at < len(flat):
        points = flat[at + 1 : at + 1 + WIDTH[flat[at]]]
        assert points.min() >= 0 and points.max() < n_points
        at += 1 + WIDTH[flat[at]]
        cells += 1
    assert cells == n_cells, f"{cells} cells in the list, {n_cells} announced"


def check(folder, kind):
    times, reference = [], None
    for grid in xml.parse(folder / f"{kind}.xdmf").getroot().iterfind("./Domain/Grid/Grid"):
        time = float(grid.find("Time").get("Value"))
        times.append(time)
        points = table(folder, grid.find("Geometry/DataItem"))
        topology = grid.find("Topology")
        cells, n_cells = table(folder, topology.find("DataItem")), int(topology.get("NumberOfElements"))
        if topology.get("TopologyType") == "Mixed":
            check_mixed(cells, n_cells, len(points))
        else:
            assert len(cells) == n_cells and cells.max() == len(points) - 1
        if reference is None:
            reference = points
        moved = reference + time * np.outer(reference[:, 1], [1, 0, 0])
        assert np.abs(points - moved).max() < 1e-14, f"{kind}: points of time {time} are not the moved ones"
        data = {a.get("Name"): table(folder, a.find("DataItem")) for a in grid.iterfind("Attribute")}
        assert set(data) == {"displacement [m]", "pressure [Pa]", "velocity [m/s]"}, data.keys()
        assert np.abs(data["displacement [m]"][:, 0] - time * reference[:, 1]).max() < 1e-14
        assert data["velocity [m/s]"].shape == (n_cells, 3)
        assert np.abs(data["pressure [Pa]"] - data["velocity [m/s]"][:, 0] - time).max() < 1e-14
    assert times == run_sample.TIMES, times


folder = run_sample.run(*sys.argv[1:4])
for kind in run_sample.KINDS:
    check(folder, kind)
    print(f"{kind}: 4 times, moved points, fields: as written")
