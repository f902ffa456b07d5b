# SPDX-License-Identifier: Apache-2.0
"""Parts of couplet study: the runs that a `study` section requests, the values read from them, and their evaluation."""
