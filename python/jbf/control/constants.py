"""Constants defined by the core: parameters of Cohn's bench, and status flags of a loop."""

from __future__ import annotations

from jbf import _core

_CORE = _core.control_constants()

DRIVE = _CORE["drive"]
"""Drive of Cohn (1998): a, b, friction scale and largest input, with the names of `Bench`."""

COUNTS_PER_RAD = _CORE["counts_per_rad"]
COUNTER_BITS = _CORE["counter_bits"]
"""Encoder of Cohn (1998): counts per radian, and width of the counter in bits."""

OBSERVER_1_S = _CORE["observer_1_s"]
"""Gain of the velocity observer of Cohn (1998), 1/s."""

TABLE_ENTRIES = _CORE["table_entries"]
"""Number of levels in a look-up table."""

SATURATED = _CORE["flags"]["saturated"]
FROZEN = _CORE["flags"]["frozen"]
JUMPED = _CORE["flags"]["jumped"]
NOT_FINITE = _CORE["flags"]["not_finite"]
FALLBACK = _CORE["flags"]["fallback"]
"""Flags of `Result.status`."""
