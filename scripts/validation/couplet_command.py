# SPDX-License-Identifier: Apache-2.0
"""Bars of "one command, one site, one package": the lists of parts/couplet_command/*.py."""
from validation.parts.couplet_command import jobs, products

BARS = [*jobs.BARS, *products.BARS]
SOURCES = ("client/python", "scripts", "packaging", "configs", "docs", "common/app")
