# SPDX-License-Identifier: Apache-2.0
"""What a configuration of preCICE asks for, as a case of Couplet (`couplet import`)."""
