# SPDX-License-Identifier: Apache-2.0
"""Conversion of a deck of CalculiX or Abaqus to a Couplet case (`couplet import`)."""
