"""A policy's numbers are numbers, and its shares are shares."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest
from jbf import InputError
from jbf.diagnosis.policy import DEFAULT


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("false_alarms", math.nan, "false_alarms is nan"),
        ("false_alarms", 0.0, "false_alarms = 0; must be above zero and below 1"),
        ("false_alarms", 1.0, "false_alarms = 1; must be above zero and below 1"),
        ("least_weight", 0.5, "least_weight = 0.5; must be above zero and below 0.5"),
        ("weak", math.nan, "weak is nan"),
    ],
)
def test_a_number_that_is_none_is_refused(name: str, value: float, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        replace(DEFAULT, **{name: value})
