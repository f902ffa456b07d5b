# SPDX-License-Identifier: Apache-2.0
"""What couplet study is made of: the runs a `study` section asks for, what is read from them, and what they say together."""
