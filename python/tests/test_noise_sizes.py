"""How large the noise is, sample by sample: records whose noise is known, and weights by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.uneven_noise import (
    FORCE_BINS,
    LEAST,
    _uneven,
    _white,
    noise_sizes,
    robust_weights,
)
from jbf.estimation.noise import WHITE
from jbf.records.findings.finding import Finding
from made_of import record, samples_of
from scipy import special

Array = npt.NDArray[np.float64]
N = 6000


def forces(n: int = N) -> Array:
    """From 1 N to 9 N and back, many times."""
    found: Array = 5.0 + 4.0 * np.sin(0.7 * np.arange(n))
    return found


def noise(n: int, seed: int) -> Array:
    return np.random.default_rng(seed).standard_normal(n)


def sizes(
    *residuals: Array,
    force: list[Array] | None = None,
    counted: list[npt.NDArray[Any]] | None = None,
    steps: list[float] | None = None,
) -> tuple[list[Array], list[Finding]]:
    """Of residuals beside a model that predicts these forces."""
    prepared = [
        record(0.02 * np.arange(len(r)), name="abcd"[i], converter_step_n=(steps or [0.0] * 9)[i])
        for i, r in enumerate(residuals)
    ]
    there = [forces(len(r)) for r in residuals] if force is None else force
    problem: Any = SimpleNamespace(
        predict=lambda values: there, campaign=SimpleNamespace(prepared=prepared)
    )
    solution: Any = SimpleNamespace(
        residuals=list(residuals), noise=WHITE, values=None, samples=samples_of(prepared, counted)
    )
    return noise_sizes(problem, solution, DEFAULT)


def weights(e: list[Array], sizes: list[Array] | None = None, heavy: float = 6.0) -> Any:
    prepared = [record(0.02 * np.arange(len(x)), name="abcd"[i]) for i, x in enumerate(e)]
    solution: Any = SimpleNamespace(residuals=e, noise=WHITE, samples=samples_of(prepared))
    return robust_weights(solution, sizes or [np.ones(len(x)) for x in e], heavy)


# ---- sizes -------------------------------------------------------------------------------------


def test_white_noise_is_what_third_differences_leave() -> None:
    """Of a parabola nothing, of white noise its size; one sample a sample, to the ends."""
    t = np.arange(50.0)
    assert _white(3.0 + t - 0.1 * t**2) == pytest.approx(np.zeros(50), abs=1e-9)
    spike = np.zeros(9)
    spike[4] = np.sqrt(20.0)
    # Third differences are 1, -3, 3, -1.
    assert _white(spike) == pytest.approx([0.0, 0.0, 1.0, -3.0, 3.0, -1.0, 0.0, 0.0, 0.0])
    assert np.std(_white(2.0 * noise(20000, 2))) == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_even_noise_has_even_weights(unit: float) -> None:
    shares, findings = sizes(unit * noise(N, 1), unit * noise(N, 2))
    assert findings == []
    assert all(np.all(s == 1.0) for s in shares)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_noise_that_grows_with_the_force_is_weighed_by_it(unit: float) -> None:
    """A cell's 0.5 N and a tenth of the force: together as the root of their squares."""
    sd = np.sqrt(0.5**2 + (0.1 * forces()) ** 2)
    force = [unit * forces(), -unit * forces()]
    shares, (found,) = sizes(unit * sd * noise(N, 1), unit * sd * noise(N, 2), force=force)
    assert (found.kind, found.channel, found.run) == ("noise_with_force", "friction_n", "a, b")
    assert (found.unit, found.done) == ("1", "weighed")
    assert found.size == pytest.approx(0.1, rel=0.06)
    assert found.words == f"the noise grows with the force, by {100 * found.size:.2g} % of it"
    for share in shares:
        assert share == pytest.approx(sd.min() / sd, rel=0.12)
        assert share.max() == 1.0
        # One over its square is the line through the squares, and one at the least force.
        slope, level = np.polyfit(forces() ** 2, share**-2.0, 1)
        assert slope * forces() ** 2 + level == pytest.approx(share**-2.0)
        assert level / slope * found.size**2 == pytest.approx(0.25, rel=0.2)


def test_noise_that_sinks_with_the_force_is_left_as_it_is() -> None:
    sd = np.sqrt(1.2**2 - (0.1 * forces()) ** 2)
    shares, findings = sizes(sd * noise(N, 1), sd * noise(N, 2))
    assert findings == []
    assert all(np.all(s == 1.0) for s in shares)


def test_the_smallest_forces_have_a_size_of_their_own() -> None:
    """Six forces, each held for a sixth of the run; at the least alone the noise is small."""
    held = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 2000)
    sd = np.where(held == 1.0, 0.55, 0.8) + 0.02 * held
    _, (found,) = sizes(sd * noise(12000, 3), force=[held])
    squares = np.array([0.57, *(0.8 + 0.02 * np.arange(2.0, 7.0))]) ** 2
    edges = np.quantile(held, np.linspace(0.0, 1.0, FORCE_BINS + 1))
    middle = 0.5 * (edges[1:] + edges[:-1])
    slope = np.polyfit(middle**2, squares, 1)[0]
    assert found.size == pytest.approx(np.sqrt(slope), rel=0.25)


def to_and_fro(sd: Array) -> Array:
    """Readings whose third differences, of white noise of that size, are all as large."""
    found: Array = np.where(np.arange(len(sd)) % 2, 1.0, -1.0) * sd
    return found


@pytest.mark.parametrize("loud", [0, 5])
def test_each_of_six_forces_has_a_size_of_its_own(loud: int) -> None:
    """At one of six, held for a sixth of the run, the noise is half or twice that of the line."""
    held = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 400)
    at = 0.2 * np.arange(1.0, 7.0)
    at[loud] *= 0.5 if loud == 0 else 2.0
    sd = np.repeat(at, 400)
    # Ends lie between the forces, so that each bin has the middle of two of them.
    edges = np.quantile(held, np.linspace(0.0, 1.0, 7))
    middle = 0.5 * (edges[1:] + edges[:-1])
    which = np.clip(np.searchsorted(edges, held) - 1, 0, 5)
    own = np.array([np.median(sd[which == k]) for k in range(6)])
    # Third differences of what goes to and fro are eight times it; 0.6745 is a normal's median.
    own *= 8.0 / np.sqrt(20.0) / 0.6745
    slope, level = np.polyfit(middle**2, own**2, 1)
    (share,), (found,) = sizes(to_and_fro(sd), force=[held])
    assert found.size == pytest.approx(np.sqrt(slope), rel=1e-9)
    least = max(level, 0.25 * own.min() ** 2)
    weight = np.sqrt((least + slope) / (least + slope * held**2))
    assert share == pytest.approx(weight, rel=1e-9)


@pytest.mark.parametrize(
    ("sd", "told"),
    [
        # A line through the squares: 1 at 1 N, and so much more at 6 N.
        (np.sqrt(1.0 + (1.4**2 - 1.0) * (np.arange(1.0, 7.0) ** 2 - 1.0) / 35.0), True),
        # In the middle alone it is larger: the line rises little.
        (np.array([1.0, 1.0, 1.3, 1.3, 1.1, 1.1]), False),
    ],
)
def test_noise_grows_with_the_force_where_the_line_rises_by_a_quarter(
    sd: Array, told: bool
) -> None:
    """From the least of the sizes; in squares 1.5625."""
    each = 4000
    held = np.repeat(np.arange(1.0, 7.0), each)
    _, found = sizes(to_and_fro(np.repeat(sd, each)), force=[held])
    assert [f.kind for f in found] == ["noise_with_force"] * told


def test_noise_that_a_larger_force_explains_is_not_the_runs() -> None:
    """One runs under 1.5 to 2.5 N, the other under twice that; both have a tenth of it as noise."""
    low = 2.0 + 0.5 * np.sin(0.7 * np.arange(N))
    force = [low, 2.0 * low]
    _, found = sizes(*(0.1 * f * noise(N, i) for i, f in enumerate(force)), force=force)
    assert [f.kind for f in found] == ["noise_with_force"]


@pytest.mark.parametrize(("count", "told"), [(-1, False), (0, True)])
def test_of_a_few_samples_the_sizes_are_not_told(count: int, told: bool) -> None:
    n = LEAST * FORCE_BINS + count
    assert (LEAST, FORCE_BINS) == (200, 6)
    _, findings = sizes(0.3 * forces(n) * noise(n, 1))
    assert bool(findings) == told


def test_without_noise_there_is_nothing_to_weigh() -> None:
    shares, findings = sizes(np.zeros(N), np.zeros(N))
    assert findings == []
    assert all(np.all(s == 1.0) for s in shares)


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_noise_that_differs_by_run_is_weighed_by_run(unit: float) -> None:
    shares, (found,) = sizes(unit * noise(N, 1), 3.0 * unit * noise(N, 2), unit * noise(N, 3))
    assert (found.kind, found.channel, found.run) == ("noise_by_run", "friction_n", "a, b, c")
    assert found.size == pytest.approx(3.0, rel=0.08)
    assert found.words == f"the noise differs by run, up to {found.size:.2g} times"
    assert (found.unit, found.done) == ("1", "weighed")
    assert [float(s.max()) for s in shares] == pytest.approx([1.0, 1.0 / 3.0, 1.0], rel=0.08)
    assert [float(np.ptp(s)) for s in shares] == [0.0, 0.0, 0.0]


def test_what_is_smooth_in_one_run_is_no_noise_of_it() -> None:
    """A wrong model leaves more there, but its third differences know nothing of it."""
    wave = 5.0 * np.sin(0.01 * np.arange(N))
    assert sizes(noise(N, 1), noise(N, 2) + wave)[1] == []


def test_a_run_of_few_samples_has_no_size_of_its_own() -> None:
    short = 3.0 * noise(LEAST, 4)
    shares, findings = sizes(noise(N, 1), short)
    assert findings == []
    assert np.all(shares[1] == 1.0)
    shares, findings = sizes(noise(N, 1), 3.0 * noise(2 * LEAST, 4))
    assert [f.kind for f in findings] == ["noise_by_run"]
    # Beside two that differ it keeps its weight.
    shares, _ = sizes(noise(N, 1), 3.0 * noise(N, 2), short)
    assert np.all(shares[2] == 1.0)


def test_the_rounding_of_a_coarse_converter_is_noise() -> None:
    """Steps of 6 N leave 1.7 N, beside white noise of 1 N: nearly all that one run has more."""
    coarse = np.sqrt(12.0) * 1.0
    quiet = 0.4 * noise(N, 1)
    assert [f.kind for f in sizes(quiet, noise(N, 2))[1]] == ["noise_by_run"]
    assert sizes(quiet, noise(N, 2), steps=[coarse, coarse])[1] == []


def test_what_does_not_count_has_no_size() -> None:
    half = np.arange(N) < N // 2
    wild = np.where(half, noise(N, 2), 50.0 * noise(N, 3))
    shares, findings = sizes(noise(N, 1), wild, counted=[np.ones(N), half])
    assert findings == []
    assert np.all(shares[1] == 1.0)


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_sizes_differ_by_a_quarter_and_by_more_than_chance(unit: float) -> None:
    many = np.array([100000, 100000])
    for ratio, apart in ((1.24, False), (1.26, True)):
        assert _uneven(unit * np.array([1.0, ratio]), many, DEFAULT) == apart
    with np.errstate(all="raise"):
        assert not _uneven(np.array([0.0, 1.0]), many, DEFAULT)
    # A relative error of 1.9 over the root of the samples, and a chi-square of one degree.
    least = special.chdtri(1, DEFAULT.deviation_chance)
    for part, apart in ((0.98, False), (1.02, True)):
        ratio = np.exp(np.sqrt(2.0 * part * least) * 1.9 / np.sqrt(900.0))
        assert ratio > DEFAULT.uneven_noise
        assert _uneven(unit * np.array([1.0, ratio]), np.array([900, 900]), DEFAULT) == apart


# ---- heavy tails -------------------------------------------------------------------------------


def tailed(outliers: int, n: int = 1000, unit: float = 1.0) -> Array:
    """Of unit robust size, some of them ten times as large."""
    e = 0.6745 * np.where(np.arange(n) % 2, 1.0, -1.0)
    e[:outliers] *= 10.0 / 0.6745
    return unit * e


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_what_is_far_off_weighs_by_its_distance(unit: float) -> None:
    """A weight on a residual whose square is Huber's on its square."""
    (weight,), (found,) = weights([tailed(20, unit=unit)])
    assert weight[:20] == pytest.approx(np.full(20, 0.5))
    assert np.all(weight[20:] == 1.0)
    assert (found.kind, found.channel, found.run) == ("heavy_tails", "friction_n", "a")
    assert (found.size, found.unit, found.done) == (0.02, "1", "weighed")
    assert found.words == "2 % of the noise is beyond four of its standard deviations"


def test_the_share_of_tails_is_told_to_two_digits() -> None:
    _, (found,) = weights([tailed(99)])
    assert found.words == "9.9 % of the noise is beyond four of its standard deviations"


@pytest.mark.parametrize(("outliers", "told"), [(4, False), (5, True)])
def test_five_samples_far_off_are_tails(outliers: int, told: bool) -> None:
    (weight,), findings = weights([tailed(outliers)])
    assert bool(findings) == told
    assert (weight.min() < 1.0) == told


@pytest.mark.parametrize(("part", "told"), [(0.9, False), (1.1, True)])
def test_tails_are_so_many_times_those_of_a_normal(part: float, told: bool) -> None:
    """Beyond four deviations lie 6.3e-5 of it; of 200,000 samples 12.7."""
    n, heavy = 200_000, 10.0
    outliers = round(part * heavy * 2.0 * special.ndtr(-4.0) * n)
    assert bool(weights([tailed(outliers, n)], heavy=heavy)[1]) == told


def test_what_is_as_large_as_its_own_noise_is_not_far_off() -> None:
    """Innovations are taken over their sizes: ten times as large in the second run."""
    e = [tailed(0, 3000), 10.0 * tailed(0)]
    (plain, far), (found,) = weights(e)
    assert found.size == 0.25
    assert np.all(plain == 1.0)
    assert far == pytest.approx(np.full(1000, np.sqrt(2.5 / 6.745)))
    assert weights(e, [np.ones(3000), np.full(1000, 0.1)])[1] == []


def test_of_nothing_there_are_no_tails() -> None:
    (weight,), findings = weights([np.zeros(100)])
    assert findings == []
    assert np.all(weight == 1.0)
    (nothing,), findings = weights([np.zeros(0)])
    assert (len(nothing), findings) == (0, [])
