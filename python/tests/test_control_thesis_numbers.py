"""The thesis's own numbers: its Tables 6.1 and 6.2 row by row, and chapter 6's first guesses."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.optimize
from jbf.control import TASKS, THESIS_BENCH, Learning, Task, assumptions, run, thesis_model
from jbf.control import thesis_tables as printed
from jbf.control.bench import with_noise
from jbf.control.schemes import NoCompensation

PRINTED = {
    "position triangle": (0.0, 10.4, 0.628, 0.474, 0.398, 0.454, 0.0894, 0.296, 0.212),
    "position square": (-1.04, 1.04, 0.25, None, 0.232, None, 0.165, None, 0.162),
    "position sine": (-1.04, 1.04, 0.25, 0.536, 0.384, 0.350, 0.0595, 0.356, 0.0615),
    "velocity sine": (-1.04, 1.04, 0.25, 0.703, 0.468, 0.127, 0.0304, 0.223, 0.0386),
    "velocity triangle": (-2.08, 2.08, 0.5, 0.563, 0.359, 0.205, 0.0337, 0.296, 0.0482),
    "velocity square": (-1.04, 1.04, 0.25, None, 0.451, None, 0.0733, None, None),
    "velocity sine 20.8": (0.52, 20.8, 0.25, 0.519, 0.210, 0.168, 0.025, 0.0895, 0.0162),
}
"""Low, high, frequency; peak and RMS error without, with the dynamic, with the Coulomb scheme."""


@pytest.mark.parametrize("row", PRINTED)
def test_a_row_is_what_the_thesis_ran_and_printed(row: str) -> None:
    low, high, frequency, *errors = PRINTED[row]
    task = TASKS[row]
    assert (task.low, task.high, task.frequency_rad_s) == (low, high, frequency)
    assert [task.control, task.wave] == row.split()[:2]
    assert printed.PRINTED_PEAK[row] == tuple(errors[::2])
    assert printed.PRINTED_RMS[row] == tuple(errors[1::2])


def test_learning_starts_from_chapter_six() -> None:
    """f_m = 0.26 and U_tr = 0.05, from which eps_tr = 0.9747; K0 = 650,000 and gamma = 33."""
    scheme = Learning()
    assert (scheme.f_m, scheme.u_tr_m_s, scheme.eps_tr) == (0.26, 0.05, 0.9747)
    assert (scheme.k0, scheme.gamma) == (650_000.0, 33.0)


@pytest.mark.parametrize("control", ["position", "velocity"])
@pytest.mark.parametrize("wave", ["sine", "triangle"])
def test_the_top_speed_is_the_references(control: str, wave: str) -> None:
    task = Task(control, wave, -0.7, 2.1, 0.8, seconds=20.0)  # type: ignore[arg-type]
    r = run(None, "none", task)
    speed = np.diff(r.reference) / THESIS_BENCH.dt_s if task.is_position else r.reference
    assert task.top_speed_rad_s == pytest.approx(np.max(np.abs(speed)), rel=1e-3)
    assert task.period_s == pytest.approx(2.0 * np.pi / 0.8)


def test_a_fit_of_the_bench_starts_at_its_answer_and_counts_its_trials(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What the seven cells without compensation miss there is their ratios' logarithms."""
    told: list[str] = []
    missed: list[float] = []

    def twice(misses, start, **_settings):  # type: ignore[no-untyped-def]
        missed.extend(misses(start))
        misses(start)
        return SimpleNamespace(x=start)

    monkeypatch.setattr(scipy.optimize, "least_squares", twice)
    model, bench = printed.fit_friction(report=lambda words, *_: told.append(words))
    assert [words.rsplit(" ", 1)[1] for words in told] == ["1", "2"]
    assert bench.volts_per_n == pytest.approx(THESIS_BENCH.volts_per_n)
    cell = run(model, "none", replace(TASKS["velocity sine"]), bench=bench)
    assert missed[list(TASKS).index("velocity sine")] == pytest.approx(np.log(cell.rms / 0.468))


@pytest.mark.parametrize("counts", [0.0, 0.2, 3.0])
def test_noise_grows_in_all_and_the_counting_has_a_share(counts: float) -> None:
    """Rounding to whole counts has the variance 1/12 (Widrow); what is added to it is the rest."""
    bench = replace(THESIS_BENCH, encoder_noise_counts=counts)
    strong = with_noise(bench, 4.0)
    ratio = (1 / 12 + strong.encoder_noise_counts**2) / (1 / 12 + counts**2)
    assert ratio == pytest.approx(16.0)
    assert strong.input_noise_v == pytest.approx(4.0 * bench.input_noise_v)


def test_the_journal_clock_would_leave_the_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the parameters of the thesis's clock its cells are off, in the worst by a factor."""
    model = thesis_model(clock="journal")
    monkeypatch.setattr(assumptions, "fit_friction", lambda **_: (model, THESIS_BENCH))
    worst = assumptions.on_the_journal_clock()
    cells = printed.tables(model, THESIS_BENCH, schemes={"none": NoCompensation()}, seeds=3)
    ratios = [cell.rms / (cell.printed_rms or np.nan) for cell in cells.column("none")]
    assert worst == pytest.approx(np.max(np.abs(np.array(ratios) - 1.0)))
    assert worst > 0.1
