# SPDX-License-Identifier: Apache-2.0
"""Bars of conjugate maps and of the work that is judged: what unit_conjugate_maps records, and the guards' claims."""
from validation.job import Bar
from validation.parts.trust.runs import gtests, tests


def recorded(name, key, limit, above=False):
    """The recorded number of a claim, which must hold itself, against a limit."""
    def measure(job):
        values, good = job.recorded("unit_conjugate_maps", name, key)
        worst = min(values) if above else max(values)
        return f"{worst:.3g}", good and (worst >= limit if above else worst <= limit)
    return measure


PAIRS = "16 pairs: flaps, rings, plates, tubes 3:2 to 7:3, triangles and quadrilaterals, a plate's two faces"
BARS = [
    Bar(f"work of any motion and load apart, {PAIRS}", "1e-12 of the work", recorded("same_work", "work_apart", 1e-12)),
    Bar("force apart, the same pairs", "1e-12", recorded("same_work", "force_apart", 1e-12)),
    Bar("moment apart, the same pairs", "1e-12", recorded("same_work", "moment_apart", 1e-12)),
    Bar("linear motion, the same pairs", "1e-12", recorded("linear_motion", "linear_off", 1e-12)),
    Bar("quadratic motion, least order of four ladders", "at least 1.8", recorded("quadratic_motion", "least_order", 1.8, above=True)),
    Bar("uniform pressure on a finer structure, largest traction over mean", "1.05", recorded("uniform_pressure", "largest_over_mean", 1.05),
        but="flaps without two fluid faces beside their sharp corners, where one vertex moves with both sides"),
    Bar("the same claims on 1, 2 and 3 ranks, both sides cut evenly or the structure on one rank", "all hold", tests("^unit_conjugate_maps", 3)),
    Bar("`nearest` where faces do not nest: 3:2, 2:3, 5:8, 7:3", "refused, projection named", gtests("unit_coupler", "nearest_is_refused")),
    Bar("work judged by net work and energy: damped oscillation, there and back", "fires, keeps still", gtests("unit_coupler", "judged_by_what_stays")),
]
