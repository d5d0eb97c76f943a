"""Which standard errors are none: of made-up models that are straight, or bent, in a parameter; and
what a fit says of its parameters."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import InputError, Parameter, ParameterValue
from jbf.estimation.curvature import BENT, doubtful_errors
from jbf.estimation.determined import HELD, NOT_SEPARATE, STATED
from jbf.estimation.estimates import Estimates
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.noise_at import noise_at
from jbf.estimation.put_back import PutBack
from jbf.estimation.solution import Solution
from jbf.estimation.spread import Spread
from jbf.estimation.uncertainty import correlations, parameter_values
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
N = 2000


def made(
    bend: tuple[float, float], *, names: tuple[str, str] = ("F_c_n", "F_v_n_s_m"), **more: Any
) -> tuple[Any, Solution]:
    """A model of two parameters, each in its own direction of the record: at a step of one standard
    error the first goes `1 + bend` times as far one way, and `1 - bend` times the other."""
    ways = [np.repeat([1.0, -1.0], N // 2), np.tile(np.repeat([1.0, -1.0], N // 4), 2)]
    unit = more.pop("unit", 1.0)
    noise = unit * np.where(np.arange(N) % 2, 1.0, -1.0)
    sd = unit / np.sqrt(N - 2)
    centre = np.array([5.0, 20.0])
    mix = more.pop("mix", 0.0)

    def residuals(values: Array, which: Any = None) -> list[Array]:
        x = (values - centre) / sd
        x = np.array([x[0] + mix * x[1], x[1]])
        gone = [sd * (u + b * u**2) for u, b in zip(x, bend, strict=True)]
        return [noise - gone[0] * ways[0] - gone[1] * ways[1]]

    bounds = more.pop("bounds", ((-1e9, 1e9), (-1e9, 1e9)))
    pages = {
        name: Parameter(name.split(".")[-1], lower=low, upper=high, starts=(1.0,))
        for name, (low, high) in zip(names, bounds, strict=True)
    }
    problem: Any = SimpleNamespace(
        open=[0, 1],
        names=names,
        parameters=pages,
        effects=more.pop("effects", ()),
        log=np.array([False, False]),
        lower=np.array([low for low, _ in bounds]),
        upper=np.array([high for _, high in bounds]),
        encode=lambda values: np.array(values, dtype=float),
        decode=lambda x, values: np.array(x, dtype=float),
        residuals=residuals,
    )
    samples = samples_of([record(0.02 * np.arange(N))])
    jacobian = [np.column_stack([ways[0], ways[1] + mix * ways[0]])]
    there = residuals(centre)
    solution = Solution(
        (), centre, there, jacobian, WHITE, samples.cost(there, WHITE), True, "", samples
    )
    return problem, solution


def doubtful(held: tuple[str, ...] = (), **given: Any) -> tuple[str, ...]:
    problem, solution = made(**given)
    values = {
        name: ParameterValue(1.0, None if name in held else 0.1, None, held=name in held)
        for name in problem.names
    }
    return doubtful_errors(problem, solution, values)


def test_where_the_likelihood_is_a_parabola_errors_are_errors() -> None:
    assert BENT == 0.3
    assert doubtful(bend=(0.0, 0.0)) == ()
    for unit in (1e-3, 1e3):
        assert doubtful(bend=(0.0, 0.0), unit=unit) == ()
        assert doubtful(bend=(0.5, 0.0), unit=unit) == ("F_c_n",)
    # However much of the one the other makes up for.
    assert doubtful(bend=(0.0, 0.0), mix=3.0) == ()


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("bend", "told"), [(0.13, False), (0.15, True), (0.9, True)])
def test_a_rise_that_is_off_by_three_tenths_on_either_side_is_none(
    way: float, bend: float, told: bool
) -> None:
    """(1 + b)^2 is 1.3 at b = 0.14; on the other side it is 0.74."""
    assert doubtful(bend=(way * bend, 0.0)) == (("F_c_n",) if told else ())
    assert doubtful(bend=(0.0, way * bend)) == (("F_v_n_s_m",) if told else ())
    both = doubtful(bend=(way * bend, -way * bend))
    assert both == (("F_c_n", "F_v_n_s_m") if told else ())


def test_of_held_ones_nothing_is_said() -> None:
    assert doubtful(bend=(0.5, 0.5), held=("F_c_n",)) == ("F_v_n_s_m",)


def test_beyond_a_bound_nothing_is_looked_for() -> None:
    """One way the bound is near: only the other is looked at, which is straight enough."""
    sd = 1.0 / np.sqrt(N - 2)
    near = ((-1e9, 5.0 + 0.5 * sd), (-1e9, 1e9))
    assert doubtful(bend=(0.139, 0.0), bounds=near) == ()
    assert doubtful(bend=(0.2, 0.0), bounds=near) == ("F_c_n",)
    assert doubtful(bend=(0.15, 0.0), bounds=near) == ()
    below = ((5.0 - 0.5 * sd, 1e9), (-1e9, 1e9))
    assert doubtful(bend=(0.15, 0.0), bounds=below) == ("F_c_n",)
    assert doubtful(bend=(-0.15, 0.0), bounds=below) == ()


def test_what_stands_at_its_bound_does_not_move_along() -> None:
    """A search stops a little inside; from there the others are looked at all the same."""
    at_bound = ((-1e9, 1e9), (-1e9, 20.0 + 1e-9))
    held = ("F_v_n_s_m",)
    assert doubtful(bend=(0.5, 0.0), bounds=at_bound, held=held) == ("F_c_n",)
    assert doubtful(bend=(0.0, 0.0), bounds=at_bound, held=held) == ()
    # What it would make up for is not made up for: the rise is larger than that of an error.
    assert doubtful(bend=(0.0, 0.0), mix=3.0, bounds=at_bound, held=held) == ("F_c_n",)
    assert doubtful(bend=(0.0, 0.0), mix=3.0, held=held) == ()


def test_peak_beside_peak_is_doubtful_unseen() -> None:
    names = ("F_c_n", "drive_compliance.k_n_m_rad")
    found = doubtful(bend=(0.0, 0.0), names=names, effects=("drive_compliance",))
    assert found == ("drive_compliance.k_n_m_rad",)
    # Whichever comes first: the other is looked at.
    first = ("drive_compliance.k_n_m_rad", "F_c_n")
    bent = doubtful(bend=(0.0, 0.5), names=first, effects=("drive_compliance",))
    assert bent == ("drive_compliance.k_n_m_rad", "F_c_n")
    one = ("F_c_n", "sensor_offset.b_n")
    assert doubtful(bend=(0.0, 0.0), names=one, effects=("sensor_offset",)) == ()


# ---- what is said of each ----------------------------------------------------------------------

PAGES = {
    "F_c_n": Parameter("F_c_n", lower=0.0, upper=1e4, starts=(4.0,)),
    "F_s_n": Parameter("F_s_n", lower=0.0, upper=1e4, starts=(4.0,)),
    "one.a": Parameter("a", lower=0.0, upper=1e4, starts=(4.0,)),
    "one.b": Parameter("b", lower=0.0, upper=1e4, starts=(4.0,)),
    "one.t": Parameter("t", lower=0.0, upper=1e4, starts=(4.0,), stated=True),
}
SPREAD = Spread(
    np.array([0.1, 0.2, 0.3]),
    np.array([1.0, 2.0, 1.0]),
    np.array([1.0, 1.0, 5.0]),
    np.arange(9.0).reshape(3, 3),
    np.array([True, True, True]),
    np.array([True, True, False]),
)


def told() -> dict[str, ParameterValue]:
    problem: Any = SimpleNamespace(parameters=PAGES, names=tuple(PAGES), open=[0, 2, 3])
    found = PutBack(np.array([5.0, 6.0, 7.0, 8.0, 20.0]), [], {})
    return parameter_values(problem, found, SPREAD)


def test_parameters_have_errors_or_are_held_and_say_why() -> None:
    assert told() == {
        "F_c_n": ParameterValue(5.0, 0.1, None, held=False),
        "F_s_n": ParameterValue(6.0, None, HELD, held=True),
        "one.a": ParameterValue(7.0, 0.4, None, held=False),
        "one.b": ParameterValue(8.0, None, NOT_SEPARATE, held=True),
        "one.t": ParameterValue(20.0, None, STATED, held=True),
    }
    problem: Any = SimpleNamespace(parameters=PAGES, names=tuple(PAGES), open=[0, 2, 3])
    noted = PutBack(np.ones(5), [], {"one.a": "put back"})
    assert parameter_values(problem, noted, SPREAD)["one.a"] == ParameterValue(
        1.0, None, "put back", held=True
    )
    # Correlations of those that are not held: the first two of three.
    assert correlations(problem, told(), SPREAD).tolist() == [[0.0, 1.0], [3.0, 4.0]]


def test_estimates_are_found_by_full_or_short_names() -> None:
    class Some(Estimates):
        parameters = told()

    found = Some()
    assert found["F_c_n"].value == 5.0
    assert found["F_c"] is found["F_c_n"]
    assert list(found) == list(PAGES)
    assert [name in found for name in ("F_c_n", "F_c", "zz", 3)] == [True, True, False, False]
    assert found.values["one.b"] == 8.0
    assert found.stderr == {"F_c_n": 0.1, "F_s_n": None, "one.a": 0.4, "one.b": None, "one.t": None}
    assert found.to_dict() == {"parameters": {n: p.to_dict() for n, p in told().items()}}
    with pytest.raises(InputError, match="zz"):
        found["zz"]


# ---- the noise at some values ------------------------------------------------------------------


def test_the_noise_is_that_of_what_counts_in_the_runs_that_are_searched() -> None:
    """Slow noise in one run, white noise in the other, wild where nothing counts."""
    random = np.random.default_rng(2)
    n = 4000
    slow = np.zeros(n)
    kicks = random.standard_normal(n)
    for k in range(1, n):
        slow[k] = np.exp(-0.1) * slow[k - 1] + kicks[k]
    white = np.where(np.arange(n) < 3000, random.standard_normal(n), 1e6 * np.sin(np.arange(n)))
    prepared = [record(0.02 * np.arange(n), name=name) for name in "ab"]
    samples = samples_of(prepared, [np.ones(n), np.arange(n) < 3000])
    every = [slow, white]

    def asked(which: list[int], most: float | None = None) -> Noise:
        problem: Any = SimpleNamespace(
            searched=which,
            residuals=lambda values, runs: [every[i] for i in runs],
            campaign=SimpleNamespace(most_noise_n=most),
        )
        return noise_at(problem, samples, np.zeros(1))

    coloured = asked([0])
    assert coloured.memory_s == pytest.approx(0.2, rel=0.25)
    assert asked([1]) == WHITE
    assert asked([0, 1]) != coloured
    # No more of it is colour than the noise can be.
    assert asked([0], 0.5).coloured_share(0.02) < 0.1
    known: Any = SimpleNamespace(searched=[0], campaign=SimpleNamespace(most_noise_n=None))
    assert noise_at(known, samples, np.zeros(1), ([slow], [])) == coloured
