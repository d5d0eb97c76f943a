"""Which starting values are taken from the data, of which laws and on which machines."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import Parameter, Rig
from jbf.estimation.scales import Scales
from jbf.estimation.starts import with_starts
from made_of import SIZES, record

module = sys.modules["jbf.estimation.starts"]
FROM_DATA = {
    "kinetic": (5.0, 7.0),
    "drive_play": (4e-3, 4e-4, 4e-5),
    # A third and a tenth of 10 s.
    "run_time": (3.0, 1.0),
    # Three hundredths of 2 N, and of its square what makes such a share there.
    "cell_play": (0.06,),
    "cell_cubic": (0.0075,),
}
CATALOGUES = (11.0, 12.0)


def page(start: str, **more: Any) -> Parameter:
    return Parameter(start, lower=1e-9, upper=1e3, starts=CATALOGUES, start=start, **more)


@pytest.mark.parametrize(
    ("in_newtons", "bearing", "taken"),
    [
        (True, False, {"kinetic", "drive_play", "run_time", "cell_play", "cell_cubic"}),
        # The catalogue's values of a drive are those of a shaft.
        (True, True, {"kinetic", "run_time", "cell_play", "cell_cubic"}),
        # Coefficients know no newtons; a cell's errors are newtons whatever the law.
        (False, True, {"cell_play", "cell_cubic"}),
        (False, False, {"cell_play", "cell_cubic"}),
    ],
)
def test_starts_are_the_datas_where_a_law_has_newtons(
    in_newtons: bool, bearing: bool, taken: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def scales(campaign: Any) -> Scales:
        asked.append(campaign)
        return SIZES

    monkeypatch.setattr(module, "scales", scales)
    run = record(np.linspace(0.0, 10.0, 101), friction=np.full(101, 2.0))
    campaign: Any = SimpleNamespace(prepared=[run], rig=Rig.thesis() if bearing else Rig())
    pages = {f"my_{start}": page(start) for start in (*FROM_DATA, "catalogue")}
    found = with_starts(pages, campaign, in_newtons)
    assert list(found) == list(pages)
    for start, values in FROM_DATA.items():
        wanted = values if start in taken else CATALOGUES
        assert found[f"my_{start}"].starts == pytest.approx(wanted), start
    assert found["my_catalogue"] is pages["my_catalogue"]
    assert len(asked) == in_newtons


def test_a_pitch_is_sought_within_the_way_and_a_lateness_down_to_a_sample(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The catalogue's pitch holds where none is found; of forces in newtons alone the way bounds
    it."""
    found: dict[bool, tuple[float, ...]] = {False: (0.02, 0.5), True: ()}
    monkeypatch.setattr(module, "scales", lambda campaign: SIZES)
    monkeypatch.setattr(module, "pitches", lambda campaign, along: found[along])
    monkeypatch.setattr(module, "known_pitches", lambda rig: ())
    monkeypatch.setattr(module, "longest_pitch", lambda campaign: 0.125)
    run = record(0.125 * np.arange(81))
    campaign: Any = SimpleNamespace(prepared=[run], rig=Rig())
    pages = {start: page(start) for start in ("pitch", "ripple_pitch", "lateness")}
    told = with_starts(pages, campaign, True)
    assert (told["pitch"].upper, told["pitch"].starts) == (0.125, (0.02, 0.125))
    assert (told["ripple_pitch"].upper, told["ripple_pitch"].starts) == (0.125, CATALOGUES)
    # From 11 s by thirds to a quarter of 0.125 s: six steps.
    wanted = (*CATALOGUES, *(11.0 / 3.0**k for k in range(1, 7)))
    assert told["lateness"].starts == pytest.approx(wanted)
    other = with_starts(pages, campaign, False)
    assert other["pitch"] is pages["pitch"]
    assert other["lateness"].starts == pytest.approx(wanted)


def test_a_transition_speed_is_bounded_by_the_fastest_on_record() -> None:
    slow, fast = (record(0.1 * np.arange(9), velocity=v * np.ones(9)) for v in (0.25, -0.5))
    campaign: Any = SimpleNamespace(prepared=[slow, fast], rig=Rig())
    bounded = page("catalogue", bound="transition_speed")
    free = page("catalogue")
    found = with_starts({"U": bounded, "other": free}, campaign, False)
    # Five times that, or twice what the catalogue starts from.
    assert found["U"].upper == 24.0
    assert found["other"] is free
