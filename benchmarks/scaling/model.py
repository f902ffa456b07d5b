#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Weak and strong scaling to 1000 ranks, predicted from counts.json (counts.py) by a model of one network:
t = work/rate + messages*latency + bytes/bandwidth + (reductions + all-gathers)*log2(P)*latency + all-gathers*P*8 B/bandwidth
Usage: benchmarks/scaling/model.py [--nodes 64] [--cores 16] [--cells 1000000] [--check]
  --cells  cells of the whole scene (strong scaling), and of each rank / 10 (weak)
  --check  runs the scenes on 1 and 2 cores of this machine and prints the model's time beside the measured one"""
import argparse
import dataclasses
import json
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent


@dataclasses.dataclass
class Network:
    name: str
    latency: float    # [s] of one message from end to end
    bandwidth: float  # [B/s] of one node's port
    source: str


HDR = Network("InfiniBand HDR", 1e-6, 25e9, "200 Gb/s a port and about 1 us by MPI as commonly published, not measured here")


def pick(rows):
    """The row on one rank (its rate) and that on the most ranks (its counts)."""
    one = next((r for r in rows if r["ranks"] == 1), None)
    most = max(rows, key=lambda r: r["ranks"])
    if one is None or most["ranks"] == 1:
        raise ValueError("counts on one rank and on several are needed")
    if not one["cells"]:
        raise ValueError(f"the number of cells of scene '{one['scene']}' is not known")
    return one, most


def seconds(rows, network, ranks, cells, sharing=1):
    """Returns (work, messages, bytes, collectives) [s] of one step. `cells`: cells of each rank; `sharing`: ranks that share a node's port.
    Halo bytes go with the surface of a part, cells^((d-1)/d); the number of messages with the neighbours, and these are at most those
    counted (more ranks than were counted: as counted there); iterations are those of the scene, flat in ranks."""
    one, most = pick(rows)
    work = one["seconds"] * cells / one["cells"]
    if ranks == 1:
        return work, 0.0, 0.0, 0.0
    surface = (cells / (most["cells"] / most["ranks"])) ** ((most["dimension"] - 1) / most["dimension"])
    hops = math.log2(ranks) * network.latency
    messages = most["messages"] * network.latency
    sent = most["bytes"] * surface * sharing / network.bandwidth
    return work, messages, sent, (most["reductions"] + most["everywhere"]) * hops + most["everywhere"] * ranks * 8 / network.bandwidth


def predict(rows, network, ranks, weak, cells=None, sharing=1):
    """Efficiency: time without communication over that with it. Weak: `cells` of each rank; strong: of all ranks."""
    cells = cells or pick(rows)[0]["cells"]
    own = cells if weak else cells / ranks
    parts = seconds(rows, network, ranks, own, sharing)
    return parts[0] / sum(parts)


def groups(rows):
    found = {}
    for row in rows:
        found.setdefault((row["scene"], row["program"]), []).append(row)
    return {key: own for key, own in found.items() if own[0]["cells"] and len({r["ranks"] for r in own}) > 1}


ASSUMPTIONS = ("each rank has the same work; computation and communication do not overlap; one core's rate holds on a full node; the\n"
               "iterations of the solvers are those counted, on any number of ranks and cells; ranks of a node share one port; messages within\n"
               "a node cost what those between nodes do; no noise of the system. No scene was run on such a machine")


def predictions(rows, nodes, cores, cells, network=HDR):
    """Yields (program, ranks, weak efficiency at cells/10 a rank, strong one at `cells` in all)."""
    for (_, program), own in groups(rows).items():
        ranks = 1
        while ranks <= max(1024, nodes * cores):
            sharing = min(ranks, cores)
            yield program, ranks, predict(own, network, ranks, True, cells / 10, sharing), predict(own, network, ranks, False, cells, sharing)
            ranks *= 4


def check(build):
    """The model's time on 2 cores of one machine (no network: its work alone) beside the measured one."""
    import counts
    rows = counts.scan({n: s for n, s in counts.SCENES.items() if s.cells}, (1, 2), build)
    print("| program | 1 core [s a step] | 2 cores [s] | efficiency | model |\n|---|---|---|---|---|")
    for (_, program), own in groups(rows).items():
        one, two = sorted(own, key=lambda r: r["ranks"])
        print(f"| {program} | {one['seconds']:.4f} | {two['seconds']:.4f} | {one['seconds'] / two['seconds'] / 2:.2f} | "
              f"{predict(own, HDR, 2, False, sharing=2):.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=64)
    parser.add_argument("--cores", type=int, default=16)
    parser.add_argument("--cells", type=float, default=1e6)
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parents[1] / "build")
    parser.add_argument("--check", action="store_true")
    a = parser.parse_args()
    if min(a.nodes, a.cores, a.cells) < 1:
        parser.error("nodes, cores and cells must be at least 1")
    if a.check:
        return check(a.build.resolve())
    rows = json.loads((HERE / "counts.json").read_text())
    print(f"{HDR.name}: {HDR.latency:g} s, {HDR.bandwidth:g} B/s ({HDR.source}); {a.cores} ranks a node.\nAssumptions: {ASSUMPTIONS}.\n")
    print(f"| program | ranks | weak, {a.cells / 10:g} cells per rank | strong, {a.cells:g} cells |\n|---|---|---|---|")
    for program, ranks, weak, strong in predictions(rows, a.nodes, a.cores, a.cells):
        print(f"| {program} | {ranks} | {100 * weak:.0f} % | {100 * strong:.0f} % |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
