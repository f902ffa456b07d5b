# SPDX-License-Identifier: Apache-2.0
"""Bars of participants whose data do not agree, under test in the coupler."""
from validation.job import Bar
from validation.parts.trust.runs import gtests

BARS = [
    Bar("a participant that does not answer a changed input", "flagged by name", gtests("coupled_toy", "names_the_participant_that_did_not_answer")),
    Bar("a velocity that is not the rate of the displacement beside it", "flagged by name", gtests("coupled_toy", "not_the_rate_of_the_displacement")),
]
