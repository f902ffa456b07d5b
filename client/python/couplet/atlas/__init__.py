# SPDX-License-Identifier: Apache-2.0
"""The atlas of stability: maps of where each scheme holds, from runs of the shipped programs (scripts/stability)."""
