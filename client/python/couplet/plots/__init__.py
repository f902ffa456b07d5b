# SPDX-License-Identifier: Apache-2.0
"""Pictures that a case declares in its section `plot`: what is drawn (section.py), from which values (sources.py), and how (draw.py)."""
