# SPDX-License-Identifier: Apache-2.0
"""python3 -m couplet ..."""
import sys

from couplet.command import main

sys.exit(main(sys.argv))
