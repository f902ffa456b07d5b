# SPDX-License-Identifier: Apache-2.0
"""A case for other programs: CalculiX input and OpenFOAM cases from the YAML, run and read back in Couplet's own
formats."""
