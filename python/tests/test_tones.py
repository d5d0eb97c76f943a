"""Lines of a spectrum that is put together by hand, and sines of known frequency and size."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.tones import find_tones
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
STEP_S = 0.02
ANY_SHARE = replace(DEFAULT, tone_share=1e-12)


def flat(n: int, lines: dict[int, float], seed: int = 0) -> Array:
    """A signal whose spectrum has the power 1 at every line but these (line to power)."""
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, n // 2 + 1)
    size = np.ones(n // 2 + 1)
    size[0] = 0.0
    for k, power in lines.items():
        size[k] = np.sqrt(power)
    return np.fft.irfft(size * np.exp(1j * phases), n)


def runs(*signals: Array) -> list[Any]:
    return [record(STEP_S * np.arange(len(s)), name="abcdef"[i]) for i, s in enumerate(signals)]


def found(
    *signals: Array, share: float = 1e-12, counted: list[npt.NDArray[Any]] | None = None
) -> list[Remainder]:
    prepared = runs(*signals)
    policy = replace(DEFAULT, tone_share=share)
    return find_tones(prepared, samples_of(prepared, counted), signals, signals, policy)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("part", "told"), [(0.98, False), (1.02, True)])
def test_a_line_is_told_where_chance_makes_none_of_that_height(
    unit: float, part: float, told: bool
) -> None:
    """Of white noise a line's power is exponential, its median log 2 times the mean: in 503 lines
    one of so many means is rarer than the policy's chance (Fisher 1929)."""
    n = 1024
    lines = n // 2 - 8
    height = np.log(lines / DEFAULT.tone_chance) / np.log(2.0)
    assert bool(found(unit * flat(n, {100: part * height}))) == told


@pytest.mark.parametrize(("turns", "told"), [(7, False), (8, False), (9, True), (512, True)])
def test_a_line_makes_more_than_eight_turns(turns: int, told: bool) -> None:
    assert bool(found(flat(1024, {turns: 1e3}))) == told


@pytest.mark.parametrize(("samples", "told"), [(63, False), (64, True)])
def test_fewer_than_64_samples_have_no_spectrum_and_the_next_run_has(
    samples: int, told: bool
) -> None:
    short, other = flat(samples, {20: 1e3}), flat(1024, {100: 1e4})
    (both,) = found(short, other)
    assert ("in all runs" in both.where or "in a" in both.where) == told
    assert bool(found(short)) == told
    # Nor does one in which nothing happens keep the next from being looked at.
    (after,) = found(np.zeros(1024), flat(1024, {100: 1e4}), np.ones(512), other)
    assert after.where.endswith("in b, d")
    quiet = flat(1024, {})
    (after,) = found(quiet, other)
    assert after.where.endswith("in b")
    assert found(quiet, quiet) == []


@pytest.mark.parametrize("off", [-0.4, 0.0, 0.2])
def test_between_lines_a_sine_has_its_own_frequency_and_size(off: float) -> None:
    """To a twentieth of a line's width: 2.5 mHz."""
    n = 1000
    time = STEP_S * np.arange(n)
    frequency = (100.0 + off) / (n * STEP_S)
    noise = 0.01 * np.random.default_rng(1).standard_normal(n)
    (one,) = found(2.5 * np.sin(2.0 * np.pi * frequency * time + 0.7) + noise)
    assert one.axis == "frequency"
    assert one.where == f"a {frequency:.2f} Hz tone, amplitude 2.5 N, in all runs"
    assert one.share == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(("off", "told"), [(-0.4, "4.90"), (0.4, "5.10"), (0.8, "5.20")])
def test_a_frequency_is_told_to_a_twentieth_of_a_line(off: float, told: str) -> None:
    """Four seconds have a line each 0.25 Hz; sought is to the next ones on both sides."""
    time = STEP_S * np.arange(200)
    frequency = 5.0 + 0.25 * off
    (one,) = found(np.sin(2.0 * np.pi * frequency * time) + 1e-3 * flat(200, {}))
    assert one.where == f"a {told} Hz tone, amplitude 1 N, in all runs"


def test_the_share_is_half_the_squares_of_the_sizes() -> None:
    """Sines of 2 N and 1 N in two runs, none in a third: 2000 and 500 of what is left in all."""
    n = 1000
    time = STEP_S * np.arange(n)
    noise = 1.5 * np.random.default_rng(2).standard_normal((3, n))
    signals = [
        noise[0] + 2.0 * np.sin(2.0 * np.pi * 5.0 * time),
        noise[1] + 1.0 * np.cos(2.0 * np.pi * 9.0 * time),
        noise[2],
    ]
    total = sum(float(x @ x) for x in signals)
    (told,) = found(*signals)
    assert told.share == pytest.approx(2500.0 / total, rel=0.15)
    assert told.where.startswith("tones: 5.00 Hz of 2")
    assert told.where.endswith(" N in b")
    assert found(*signals, share=0.9 * told.share) != []
    assert found(*signals, share=told.share) != []
    assert found(*signals, share=1.1 * told.share) == []


def test_what_does_not_count_has_no_part_in_the_size() -> None:
    n = 1000
    time = STEP_S * np.arange(n)
    sine = 2.0 * np.sin(2.0 * np.pi * 5.0 * time)
    prepared = runs(sine)
    residual = np.where(np.arange(n) < 500, 3.0 * sine, sine)
    samples = samples_of(prepared, [np.arange(n) >= 500])
    (told,) = find_tones(prepared, samples, [sine + 1e-3], [residual], ANY_SHARE)
    assert "5.00 Hz tone, amplitude 2 N" in told.where
    # No share is more than all.
    assert told.share == 1.0


@pytest.mark.parametrize(("apart", "one"), [(0.1, True), (0.3, False)])
def test_tones_within_a_fiftieth_of_one_another_are_one(apart: float, one: bool) -> None:
    """Of 5.0 Hz the median differs by half of that: 0.12 Hz are one, 2 % and 0.02 Hz."""
    n = 2000
    time = STEP_S * np.arange(n)
    signals = [
        size * np.sin(2.0 * np.pi * f * time) + 1e-3 * flat(n, {}, seed)
        for seed, (f, size) in enumerate(((5.0, 1.0), (5.0 + apart, 2.0)))
    ]
    (told,) = found(*signals)
    middle = 5.0 + 0.5 * apart
    if one:
        assert told.where == f"a {middle:.2f} Hz tone, amplitude 1.5 N, in all runs"
    else:
        assert told.where == f"tones: 5.00 Hz of 1 N in a, {5.0 + apart:.2f} Hz of 2 N in b"


def test_a_run_whose_steps_are_uneven_keeps_no_other_from_being_looked_at() -> None:
    """Of its usual step no line makes eight turns in the time that it lasts."""
    sine = 2.0 * np.sin(0.2 * np.pi * np.arange(1000)) + 1e-3 * flat(1000, {})
    prepared = runs(sine, sine)
    prepared[0].step_s = 100.0
    (told,) = find_tones(prepared, samples_of(prepared), [sine] * 2, [sine] * 2, ANY_SHARE)
    assert told.where.endswith("in b")
