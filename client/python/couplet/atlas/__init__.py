# SPDX-License-Identifier: Apache-2.0
"""The atlas of stability: maps of where each scheme is stable, from runs of the shipped programs (scripts/stability)."""
