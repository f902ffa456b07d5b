# SPDX-License-Identifier: Apache-2.0
"""Wrong plates; joined by table.py."""

# Of plate.yaml: what modes of a file take the place of.
OF_MESH = """    mesh: square.msh
    material: {density: 1000, youngs-modulus: 1 GPa, poissons-ratio: 0.3}
    thickness: 1 cm
    boundaries:
      bottom: {type: clamped}
      top: {type: free}
      left: {type: free}
      right: {type: free}
"""


def cases(Case, run):
    """The right ones and the wrong ones."""
    def plate(name, message, *edits, **more):
        return Case(name, "plate_modal", message, "plate", list(edits), **more)

    def file_alone(name, more=""):
        """Edits: the modes of a file in place of a mesh and what goes with it."""
        return [(OF_MESH, more), ("modes: {number: 3}", f"modes: {{file: {name}}}")]

    def of_no_use(key, line, reason, column=5):
        return plate(f"'{key}' beside modes of a file", f"""
case.yaml:6:{column}: participants.plate.{key}: it has no effect with 'modes.file': {reason}.
""", *file_alone("modes.h5", f"    {line}\n"), ("    contact: {height: -1 cm}\n", ""))

    right = [
        plate("right plate", "", exit_code=0),
        plate("right plate that runs", "", exit_code=0, **run),
    ]
    wrong = [
        plate("plate without mesh or modes", """
case.yaml:4:3: participants.plate.mesh: give either 'mesh' (of the mid-surface) or 'modes.file' (modes of another program).
""", ("    mesh: square.msh\n", "")),
        plate("plate with mesh and modes", """
case.yaml:6:5: participants.plate.mesh: give either 'mesh' (of the mid-surface) or 'modes.file' (modes of another program).
""", ("modes: {number: 3}", "modes: {number: 3, file: modes.h5}")),
        plate("parameters of a finished mesh of a plate", """
[plate 0] error: The mesh 'square.msh' is already meshed, so 'mesh-parameters' cannot change it. Remove them, or give the .geo it was made from.
""", ("    mesh: square.msh\n", "    mesh: square.msh\n    mesh-parameters: {n: 3}\n"), **run),
        plate("mesh of a plate of another kind", """
[plate 0] error: The mesh file 'case.yaml' is not a .msh, .geo, .unv, .med, .exo or .cgns file.
""", ("    mesh: square.msh\n", "    mesh: case.yaml\n"), **run),
        plate("plate without thickness", """
case.yaml:6:5: participants.plate.mesh: a plate needs 'thickness' above 0.
""", ("    thickness: 1 cm\n", "")),
        plate("plate without density", """
case.yaml:6:5: participants.plate.mesh: a plate needs 'material.density' above 0.
""", ("density: 1000, ", "")),
        plate("axes of a plate that are not at right angles", """
case.yaml:9:17: participants.plate.placement.x-axis: x-axis and y-axis must be at right angles, and not 0.
""",
              ("    thickness: 1 cm\n", "    thickness: 1 cm\n    placement: {x-axis: [1, 0, 0], y-axis: [1, 0, 0]}\n")),
        plate("edge held in an unknown way", """
case.yaml:10:16: participants.plate.boundaries.bottom.type: 'clampd' is not one of: free, clamped, simply-supported, symmetry. Did you mean 'clamped'?
""", ("bottom: {type: clamped}", "bottom: {type: clampd}")),
        plate("conserving contact with another scheme", """
case.yaml:16:5: participants.plate.contact: 'rule: conserving' requires the trapezoidal time scheme; use 'rule: midpoint'.
""",
              ("modes: {number: 3}", "modes: {number: 3}\n    time-scheme: {type: bathe}")),
        plate("contact in a static analysis", """
case.yaml:16:5: participants.plate.contact: contact requires a dynamic analysis; remove it.
""", ("    mesh:", "    analysis: static\n    mesh:")),
        plate("damping in a modal analysis", """
case.yaml:7:5: participants.plate.damping: damping has no effect in this analysis; remove it.
""", ("    mesh:", "    analysis: modal\n    damping: {ratio: 0.1}\n    mesh:"),
              ("    contact: {height: -1 cm}\n", "")),
        plate("direction of a seat that is none", """
case.yaml:15:30: participants.plate.contact.direction: a direction is needed, not 0.
""", ("{height: -1 cm}", "{height: -1 cm, direction: [0, 0, 0]}")),
        plate("stiffness of a seat and a scale", """
case.yaml:15:52: participants.plate.contact.scale: it has no effect with 'stiffness': it scales (4.33) only.
""", ("{height: -1 cm}", "{height: -1 cm, stiffness: 1e6 N/m^3, scale: 2}")),
        plate("cavity without a file", """
case.yaml:14:24: participants.plate.modes.cavity: it applies to a 'file' only.
""", ("{number: 3}", "{number: 3, cavity: true}")),
        plate("scale of a mesh beside modes of a file", """
case.yaml:6:5: participants.plate.mesh-scale: it has no effect with 'modes.file': the file is in metres.
""", *file_alone("modes.h5", "    mesh-scale: 0.001\n"), ("    contact: {height: -1 cm}\n", "")),
        plate("height of a seat that cannot be read", """
case.yaml:15:15: participants.plate.contact.height: cannot parse the expression '0.1 * r' at column 7: unknown name 'r'. Known are the variables x, y, z [m] and t [s], the constant pi, the operators + - * / ^ < > == && || ?: and functions such as sin, cos, exp, sqrt, abs, min, max.
""", ("{height: -1 cm}", "{height: 0.1 * r}")),
        plate("gravity of two components", """
case.yaml:15:5: participants.plate.gravity: expected a list of 3 entries, found 2.
""", ("modes: {number: 3}", "modes: {number: 3}\n    gravity: [0, -9.81]")),
        plate("amplitudes of modes that are not kept", """
case.yaml:15:5: participants.plate.initial-amplitudes: 4 amplitudes are given, but there are 3 modes.
""",
              ("modes: {number: 3}", "modes: {number: 3}\n    initial-amplitudes: [1, 2, 3, 4]")),
        plate("seat of unknown stiffness", """
case.yaml:7:5: participants.plate.contact: with 'modes.file' the material is unknown: give 'stiffness'.
""", *file_alone("modes.h5")),
        plate("edge of a plate without an entry", """
[plate 0] error: participants.plate.boundaries: patch 'top' has no entry; give it type: free, clamped, simply-supported or symmetry.
""", ("      top: {type: free}\n", ""), **run),
        plate("edge of a plate that is not there", """
[plate 0] error: participants.plate.boundaries: the mesh has no patch 'tip'; it has 'left', 'right', 'bottom', 'top'.
""", ("      top: {type: free}\n", "      top: {type: free}\n      tip: {type: free}\n"), **run),
        plate("zone of a plate that is not there", """
[plate 0] error: participants.plate.zones: the mesh has no zone 'rim'; it has 'inside'.
""",
              ("    boundaries:", "    zones: {rim: {thickness: 1 mm}}\n    boundaries:"), **run),
        plate("more modes than a plate has", """
[plate 0] error: 300 modes are requested, but the plate has 18 free unknowns, and one mode must be left over. Request fewer, or use a finer mesh: modes beyond a tenth of the unknowns are mesh artefacts.
""", ("number: 3", "number: 300"), **run),
        plate("as many modes as a plate has unknowns that are not held", """
[plate 0] error: 18 modes are requested, but the plate has 18 free unknowns, and one mode must be left over. Request fewer, or use a finer mesh: modes beyond a tenth of the unknowns are mesh artefacts.
""", ("number: 3", "number: 18"), **run),
        plate("modes of a file that is not there", """
[plate 0] error: The modes file 'modes.h5' does not exist. The path is relative to the folder of the YAML file.
""", *file_alone("modes.h5"), ("    contact: {height: -1 cm}\n", ""), **run),
        plate("modes of a file of another kind", """
[plate 0] error: Cannot use the modes file 'square.msh': it is not an HDF5 file, or its beginning is damaged (file signature not found). docs/formats.md describes the required content.
""", *file_alone("square.msh"), ("    contact: {height: -1 cm}\n", ""), **run),
        plate("static analysis of a plate that nothing holds", """
[plate 0] error: The structure moves as a rigid body (mode 1 has zero frequency): a static analysis needs supports that prevent this.
""", ("    mesh:", "    analysis: static\n    mesh:"),
              ("bottom: {type: clamped}", "bottom: {type: free}"), ("    contact: {height: -1 cm}\n", ""), **run),
        plate("seat where there is no plate", """
[plate 0] error: contact: no face of the structure points towards the seat. Check 'direction' and 'where'.
""", ("{height: -1 cm}", "{height: -1 cm, where: x - 3}"), **run),
        plate("plate in its seat at the start", """
[plate 0] error: contact: initially the structure is 0.003 m inside the seat, deepest at (0.25, 0.25, -0.005). Lower 'height' (it counts from the origin along the direction; a side of a plate is half a thickness from its mid-surface), or set 'starts-inside: true' if these springs are meant to push from the start.
""", ("{height: -1 cm}", "{height: -2 mm}"), **run),
        plate("seat that moves", """
case.yaml:15:15: participants.plate.contact.height: the seat is at rest: use an expression of x, y, z, without t.
""", ("{height: -1 cm}", "{height: -0.01 + 0.001 * sin(t)}")),
        plate("seat that comes and goes", """
case.yaml:15:30: participants.plate.contact.where: the seat is at rest: use an expression of x, y, z, without t.
""", ("{height: -1 cm}", "{height: -1 cm, where: t - 0.05}")),
        plate("seat along which nothing moves", """
[plate 0] error: contact.direction: the modes move the faces towards the seat along (0, 1, 0) by only 0 % of their motion; at least 50 % is needed for contact. The seat must lie across the motion.
""", ("{height: -1 cm}", "{height: -3, direction: [0, 1, 0], stiffness: 1e6}"), ("bottom: {type: clamped}", "bottom: {type: free}"),
              ("top: {type: free}", "top: {type: clamped}"), **run),
        of_no_use("thickness", "thickness: 1 cm", "the modes include it already"),
        of_no_use("material", "material: {density: 1000}", "the modes include it already"),
        of_no_use("boundaries", "boundaries: {left: {type: free}}", "the modes include it already"),
        of_no_use("zones", "zones: {tip: {thickness: 1 mm}}", "the modes include it already"),
        of_no_use("wetted", "wetted: upper", "the interface is the surface of the file"),
        of_no_use("placement", "placement: {origin: [0, 0, 1]}", "the file defines the position of the surface"),
        plate("number of modes beside a file of modes", """
case.yaml:7:29: participants.plate.modes.number: it has no effect with 'modes.file': all modes of the file are used.
""", *file_alone("modes.h5, number: 3", "    surface-density: true\n")),
        plate("half a mode", """
case.yaml:14:13: participants.plate.modes.number: a whole number is needed.
""", ("number: 3", "number: 3.5")),
        plate("pressure on a side that is not there", """
[plate 0] error: load.lower-pressure: the surface of the structure has no face on this side (-0, -0, -1).
""", ("modes: {number: 3}", "modes: {number: 3}\n    wetted: upper\n    load: {lower-pressure: 3}"), ("    contact: {height: -1 cm}\n", ""), **run),
        plate("probe far from the plate", """
[plate 0] error: participants.plate.probes.tip: (0, 2, 0) is 1 m away from the surface of the structure; 0.0141 m at most is allowed.
""",
              ("modes: {number: 3}", "modes: {number: 3}\n    probes: {tip: {point: [0, 2, 0]}}"), **run),
    ]
    return right, wrong
