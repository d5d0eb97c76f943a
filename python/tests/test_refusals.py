"""Calls that are wrong in a way that Python lets pass: one line says what to mend."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from by_hand import coulomb, there_and_back
from jbf import InputError, Model, Rig, compare, diagnose, fit

RUNS = there_and_back(coulomb, noise_n=0.1)


def refused(call: Callable[[], Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["presliding", "sensor_offset", ""])
def test_text_where_a_list_of_names_is_meant(name: str) -> None:
    words = "effects is text where a list of names is meant"
    refused(lambda: fit(Rig(), RUNS, name, law="coulomb"), words)
    refused(lambda: fit(Rig(), RUNS, effects=name, law="coulomb"), words)
    refused(lambda: Model(Rig(), "coulomb", effects=name), words)


def test_a_clock_that_there_is_none_of() -> None:
    rig = Rig.thesis()
    refused(lambda: fit(rig, RUNS, clock="Thesis"), "Thesis")
    refused(lambda: Model(rig, clock="Thesis"), "Thesis")
    refused(lambda: diagnose(rig, RUNS, clock="Thesis"), "Thesis")


def test_a_law_and_an_effect_that_there_is_none_of() -> None:
    refused(lambda: fit(Rig(), RUNS, law="coulombs"), "coulombs")
    refused(lambda: fit(Rig(), RUNS, ["sensor_ofset"], law="coulomb"), "sensor_ofset")
    refused(lambda: compare(Model(Rig(), "coulomb"), []), "no run")
