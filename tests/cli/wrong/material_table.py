# SPDX-License-Identifier: Apache-2.0
"""Wrong materials of solids and heat; joined by table.py."""

ENTRIES = """    boundaries:
      left: {type: fixed-displacement, value: [0, 0]}
      right: {type: traction, value: [1000, 0]}
      bottom: {type: free}
      top: {type: free}
"""


def cases(solid):
    return [
        solid("no material", """
case.yaml:4:3: participants.solid.material: give either 'material' (of the whole solid) or 'materials' (by zone of the mesh).
""", ("    material:\n      density: 1000 kg/m^3\n      youngs-modulus: 1 MPa\n"
                             "      poissons-ratio: 0.3\n", "")),
        solid("one material and several", """
case.yaml:9:5: participants.solid.material: give either 'material' (of the whole solid) or 'materials' (by zone of the mesh).
""", ("    boundaries:", "    materials: {rubber: {density: 1000, youngs-modulus: 1e7, "
                                           "poissons-ratio: 0.4}}\n    boundaries:")),
        solid("orthotropic constants of no body", """
case.yaml:11:54: participants.solid.material.orthotropic.poissons-ratios: these moduli violate positive strain energy: |nu_ij| must be below sqrt(E_i / E_j), and 1 - nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 positive (nu_ji = nu_ij E_j / E_i).
""", ("      youngs-modulus: 1 MPa\n      poissons-ratio: 0.3\n",
          "      orthotropic: {youngs-moduli: [15e6, 1e6, 1e6], poissons-ratios: [4, 0.3, 0.3], shear-moduli: [1e6, 1e6, 1e6]}\n")),
        solid("orthotropic and isotropic", """
case.yaml:11:7: participants.solid.material.orthotropic: give either 'orthotropic' or 'youngs-modulus' and 'poissons-ratio'.
""", ("      youngs-modulus: 1 MPa\n",
          "      orthotropic: {youngs-moduli: [1e6, 1e6, 1e6], poissons-ratios: [0.3, 0.3, 0.3], shear-moduli: [1e6, 1e6, 1e6]}\n"
          "      youngs-modulus: 1 MPa\n")),
        solid("orthotropic at large strain", """
case.yaml:6:5: participants.solid.kinematics: an orthotropic material is linear; finite strain supports only the laws of docs/large-strain.md.
""", ("      youngs-modulus: 1 MPa\n      poissons-ratio: 0.3\n",
          "      orthotropic: {youngs-moduli: [1e6, 1e6, 1e6], poissons-ratios: [0.3, 0.3, 0.3], shear-moduli: [1e6, 1e6, 1e6]}\n"),
              ("    mesh:", "    kinematics: finite-strain\n    mesh:")),
        solid("conduction alone, whose other patches are adiabatic", "", ("analysis: dynamic", "analysis: thermal"),
              ("poissons-ratio: 0.3", "poissons-ratio: 0.3\n      conductivity: 50"),
              (ENTRIES, "    heat: {analysis: steady, boundaries: {left: {type: temperature, value: 300 K}}}\n"), exit_code=0),
        solid("heat through a patch that is not there", """
case.yaml:14:43: participants.solid.heat.boundaries.lift: the mesh has no patch with this name. Did you mean 'left'?
""", ("analysis: dynamic", "analysis: thermal"), ("poissons-ratio: 0.3", "poissons-ratio: 0.3\n      conductivity: 50"),
              (ENTRIES, "    heat: {analysis: steady, boundaries: {lift: {type: temperature, value: 300 K}}}\n")),
    ]
