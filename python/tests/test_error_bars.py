"""Every parameter on a plain scale has an error, be it small or large."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from jbf import Model, Parameter, Rig, Run, effects, fit, laws

STEP_S = 0.01
NOISE_N = 0.002
LAW_OF = {
    "no_film": "coulomb",
    "film": "journal",
    "loads": "journal",
    "no_dry_level": "journal",
}
"""Needs that Coulomb's law, on which all else is tried, does not meet."""


COMPANY = {"transmitted": ["gravity"]}
"""Needs to effects that meet them."""


def law_of(effect: str) -> str:
    needs = effects()[effect].needs
    return next((law for need, law in LAW_OF.items() if need in needs), "coulomb")


def plain() -> list[tuple[str, str, Parameter]]:
    """Law, effect (or none) and each of their parameters that is searched on a plain scale."""
    of_laws = [(law, "", p) for law, page in laws().items() for p in page.parameters if not p.log]
    of_effects = [
        (law_of(name), name, p)
        for name, e in effects().items()
        for p in e.parameters
        if not (p.log or p.stated)
    ]
    return of_laws + of_effects


def motions() -> list[Run]:
    """Two loads; a swell of two sines, then strokes with rests between; shaft angle and place."""
    t = np.arange(0.0, 12.0, STEP_S)
    swell = 0.05 * np.minimum(t, 1.0) * (np.cos(4.0 * t) + 0.7 * np.cos(1.3 * t + 1.0))
    phase = np.mod(t, 3.0)
    way = np.where(np.mod(t, 6.0) < 3.0, 1.0, -1.0)
    strokes = np.where(phase < 2.0, way * 0.08 * np.sin(0.5 * np.pi * phase) ** 2, 0.0)
    radius_m = 0.0127
    runs = []
    for name, v, load_n in (("swell", swell, 100.0), ("strokes", strokes, 140.0)):
        path = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * STEP_S)))
        runs.append(
            Run.from_arrays(
                t, v, angle_rad=path / radius_m, load_n=np.full(len(t), load_n), name=name
            )
        )
    return runs


RUNS = motions()


def check(law: str, effect: str, page: Parameter, value: float) -> None:
    """Fit the one parameter to runs made with it: it comes back, with an error."""
    name = f"{effect}.{page.name}" if effect else page.name
    rig = Rig.thesis()
    needs = effects()[effect].needs if effect else ()
    beside = [other for need, others in COMPANY.items() if need in needs for other in others]
    chosen = [*beside, effect] if effect else []
    pages = ((e, p) for e in chosen for p in effects()[e].parameters)
    given = {f"{e}.{p.name}": p.starts[0] for e, p in pages} | {name: value}
    truth = Model(rig, law, chosen, given)
    random = np.random.default_rng(1)
    runs = [
        replace(run, friction_n=truth.predict(run) + NOISE_N * random.standard_normal(len(run)))
        for run in RUNS
    ]
    held = dict(zip(truth.parameters, truth.values.tolist(), strict=True))
    del held[name]
    found = fit(rig, runs, chosen, law=law, start={name: value}, fixed=held).parameters[name]
    assert found.note is None
    assert found.stderr is not None
    assert 0.0 < found.stderr < 0.5 * abs(value)
    off = found.value - value
    if page.period is not None:
        off -= page.period * np.round(off / page.period)
    assert abs(off) < 4.5 * found.stderr + 1e-3 * abs(value)


@pytest.mark.parametrize("times", [0.1, 1.0, 10.0])
@pytest.mark.parametrize(
    ("law", "effect", "page"), plain(), ids=[f"{e or law}.{p.name}" for law, e, p in plain()]
)
def test_a_plain_parameter_has_its_error(
    law: str, effect: str, page: Parameter, times: float
) -> None:
    usual = next(x for x in page.starts if x != 0.0)
    # Within its bounds, and away from them.
    check(law, effect, page, float(np.clip(times * usual, 0.9 * page.lower, 0.9 * page.upper)))


@pytest.mark.parametrize(
    ("law", "name", "value"),
    [
        ("coulomb", "F_v_n_s_m", 0.3),
        ("coulomb", "quadratic_drag.c_n_s2_m2", 0.5),
        ("coulomb", "inertia_leak.m_e_kg", 0.03),
        ("journal", "coulomb_drag.F_d_n", 0.004),
    ],
)
def test_what_is_small_beside_its_bounds_is_not_at_them(law: str, name: str, value: float) -> None:
    effect, _, short = name.rpartition(".")
    pages = effects()[effect].parameters if effect else laws()[law].parameters
    check(law, effect, next(p for p in pages if p.name == short), value)
