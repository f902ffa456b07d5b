# SPDX-License-Identifier: Apache-2.0
"""Pictures declared in the section `plot` of a case: contents (section.py), values (sources.py) and drawing
(draw.py)."""
