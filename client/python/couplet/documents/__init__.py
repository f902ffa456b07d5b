# SPDX-License-Identifier: Apache-2.0
"""What is made of the programs' declarations and the project's texts: schemas for editors (scripts/docs) and the site (couplet docs)."""
