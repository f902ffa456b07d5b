# SPDX-License-Identifier: Apache-2.0
"""Documents made from the programs' declarations and the project's texts: schemas for editors (scripts/docs) and the
site (couplet docs)."""
