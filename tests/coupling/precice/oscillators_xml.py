# SPDX-License-Identifier: Apache-2.0
"""Configurations of preCICE for the two programs of oscillators."""

EXCHANGES = """
    <max-time value="{end}" />
    <time-window-size value="0.1" />
    <exchange data="Displacement-Left" mesh="Left-Mesh" from="Left" to="Right" initialize="{initialize}"{substeps} />
    <exchange data="Displacement-Right" mesh="Right-Mesh" from="Right" to="Left" initialize="{initialize}"{substeps} />"""
IMPLICIT = """
    <max-iterations value="{iterations}" />
    <relative-convergence-measure limit="1e-12" data="Displacement-Right" mesh="Right-Mesh" />
    <acceleration:IQN-ILS><data name="Displacement-Right" mesh="Right-Mesh" /><initial-relaxation value="0.5" /></acceleration:IQN-ILS>"""


def configuration(scheme, initialize="true", end=1, iterations=50, degree=None, substeps=None):
    """degree, substeps: None: as preCICE has it where nothing is said, a line in time through the values at all sub-steps."""
    body = EXCHANGES + (IMPLICIT if "implicit" in scheme else "")
    sides = "".join(f"""
  <participant name="{me}">
    <provide-mesh name="{me}-Mesh" />
    <receive-mesh name="{other}-Mesh" from="{other}" />
    <write-data name="Displacement-{me}" mesh="{me}-Mesh" />
    <read-data name="Displacement-{other}" mesh="{me}-Mesh" />
    <mapping:nearest-neighbor direction="read" from="{other}-Mesh" to="{me}-Mesh" constraint="consistent" />
  </participant>""" for me, other in (("Left", "Right"), ("Right", "Left")))
    meshes = "".join(f'\n  <mesh name="{s}-Mesh" dimensions="2"><use-data name="Displacement-Left" /><use-data name="Displacement-Right" /></mesh>' for s in ("Left", "Right"))
    return f"""<?xml version="1.0" encoding="UTF-8" ?>
<!-- pairs of masses -->
<precice-configuration>
  <log><sink filter="%Severity% > debug" /></log>
  <data:scalar name="Displacement-Left"{f' waveform-degree="{degree}"' if degree is not None else ''} />
  <data:scalar name="Displacement-Right"{f' waveform-degree="{degree}"' if degree is not None else ''} />{meshes}{sides}
  <m2n:sockets acceptor="Left" connector="Right" />
  <coupling-scheme:{scheme}>
    <participants first="Left" second="Right" />{body.format(initialize=initialize, end=end, iterations=iterations, substeps=f' substeps="{substeps}"' if substeps else '')}
  </coupling-scheme:{scheme}>
</precice-configuration>
"""
