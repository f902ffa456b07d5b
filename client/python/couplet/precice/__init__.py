# SPDX-License-Identifier: Apache-2.0
"""Conversion of a preCICE configuration to a Couplet case (`couplet import`)."""
