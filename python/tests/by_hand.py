"""Records and results with given round numbers, which tests of reports compare with their output.

Coulomb friction on motions that never reverse is linear in its parameters, so that estimates and
standard errors are those of linear least squares.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from jbf import Comparison, Diagnosis, Fit, Model, ParameterValue, Rig, Run, compare, fit
from jbf.diagnosis import Remainder, Step, Trial
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.selection import CHANCE
from jbf.estimation.noise import WHITE

Array = npt.NDArray[np.float64]
Friction = Callable[[Array, Array, Array], Array]

STEP_S = 0.02
LAW = {"F_c": 5.0, "F_v": 20.0}


def one_way(
    name: str,
    friction: Friction,
    *,
    direction: float = 1.0,
    rate: float = 2.0,
    duration_s: float = 10.0,
    noise_rms: float = 0.0,
    seed: int = 0,
) -> Run:
    """A run at 0.05 to 0.15 m/s in one direction.

    `friction` is a function of time, speed and acceleration. The argument `direction` multiplies
    the speed and may be a sign; `rate` is the angular frequency of the speed, 1/s.
    """
    t = np.arange(0.0, duration_s + 0.5 * STEP_S, STEP_S)
    v = direction * (0.1 + 0.05 * np.sin(rate * t))
    a = direction * 0.05 * rate * np.cos(rate * t)
    noise = noise_rms * np.random.default_rng(seed).standard_normal(len(t))
    return Run.from_arrays(t, v, friction(t, v, a) + noise, name=name)


def wandering(
    name: str, friction: Friction, *, direction: float, rate: float, noise_rms: float, seed: int
) -> Run:
    """A run like `one_way` whose speed has two frequencies without a common period."""
    t = np.arange(0.0, 10.0 + 0.5 * STEP_S, STEP_S)
    other = 0.6180340 * rate
    v = direction * (0.1 + 0.03 * np.sin(rate * t) + 0.02 * np.sin(other * t + 1.0))
    a = direction * (0.03 * rate * np.cos(rate * t) + 0.02 * other * np.cos(other * t + 1.0))
    noise = noise_rms * np.random.default_rng(seed).standard_normal(len(t))
    return Run.from_arrays(t, v, friction(t, v, a) + noise, name=name)


def four_runs(friction: Friction, *, noise_rms: float, seed: int = 0) -> list[Run]:
    """Two `wandering` runs in each direction: any three determine the prediction of the fourth."""
    plan = (("a", 1.0, 12.0), ("b", -1.0, 14.0), ("c", 1.0, 10.0), ("d", -1.0, 16.0))
    return [
        wandering(
            name, friction, direction=direction, rate=rate, noise_rms=noise_rms, seed=4 * seed + i
        )
        for i, (name, direction, rate) in enumerate(plan)
    ]


def there_and_back(friction: Friction, *, noise_rms: float = 0.0, seed: int = 0) -> list[Run]:
    """A run in each direction of motion, named `there` and `back`; no sample is at rest."""
    return [
        one_way("there", friction, noise_rms=noise_rms, seed=2 * seed),
        one_way("back", friction, direction=-1.0, rate=3.0, noise_rms=noise_rms, seed=2 * seed + 1),
    ]


def coulomb(t: Array, v: Array, a: Array) -> Array:
    """Dry friction of 5 N and viscous friction of 20 N s/m."""
    return LAW["F_c"] * np.sign(v) + LAW["F_v"] * v


def along(more_n: float) -> Friction:
    """`coulomb` with a dry friction that is larger by `more_n`."""
    return lambda t, v, a: coulomb(t, v, a) + more_n * np.sign(v)


def assert_recovered(
    estimate: ParameterValue, true: float, *, errors: float = 4.0, share: float = 0.0
) -> None:
    """Check that an estimate is within its standard errors plus a share of the true value."""
    assert estimate.stderr is not None
    assert abs(estimate.value - true) < errors * estimate.stderr + share * abs(true)


@cache
def _computed() -> tuple[Fit, Comparison]:
    """A computed fit and comparison, in which the functions below replace numbers."""
    fitted = fit(Rig(), there_and_back(coulomb, noise_rms=0.1), law="coulomb")
    compared = compare(Model(Rig(), "coulomb", parameters=LAW), there_and_back(along(1.0)))
    campaign = compared.campaign
    # Records without noise have a finding that states this.
    without_findings = tuple(
        replace(p, examined=replace(p.examined, findings=())) for p in campaign.prepared
    )
    return fitted, replace(compared, campaign=replace(campaign, prepared=without_findings))


def fit_by_hand(effects: Sequence[str] = (), *, doubtful: tuple[str, ...] = ()) -> Fit:
    """A fit of three law parameters, one of which is held, and of the sensor offset if given."""
    parameters = {
        "F_c": ParameterValue(4.9876, 0.0123),
        "F_s": ParameterValue(6.0, None, "held fixed", held=True),
        "F_v": ParameterValue(20.44, 0.52),
    }
    if "sensor_offset" in effects:
        parameters["sensor_offset.b"] = ParameterValue(-0.25, 0.025)
    table = np.array([[1.0, -0.9, 0.45], [-0.9, 1.0, 0.1], [0.45, 0.1, 1.0]])
    size = len(parameters) - 1
    fitted = _computed()[0]
    return replace(
        fitted,
        model=Model(Rig(), "coulomb", effects, parameters),
        parameters=parameters,
        correlations=table[:size, :size],
        rms=0.525,
        noise_floor=0.5,
        noise=replace(fitted.noise, colour=0.25, memory_s=0.15),
        nobs=1001,
        converged=True,
        doubtful=doubtful,
    )


def comparison_by_hand(rms: float, runs_rms: tuple[float, float]) -> Comparison:
    """A comparison with one failure and a noise floor of 0.5 N."""
    computed = _computed()[1]
    counts = (501, 500)
    runs = tuple(
        replace(r, rms=x, samples=n)
        for r, x, n in zip(computed.runs, runs_rms, counts, strict=True)
    )
    direction = next(f for f in computed.failures if f.axis == "direction")
    pattern = replace(direction, where="record above the model", share=0.6)
    return replace(computed, rms=rms, noise_rms=0.5, runs=runs, failures=(pattern,))


TRIALS = (
    Trial("sensor_offset", 0.525, 812.4, "added", "largest evidence"),
    Trial("sensor_drift", 1.5, 55.0, "ties", "fits as well as sensor_offset"),
    Trial("inertia", 2.0, 7.4, "rejected", "evidence is 805 below that of sensor_offset"),
    Trial("sensor_lag", 2.5, -26.2, "no gain", CHANCE),
)
RESIDUAL_STRUCTURE = (
    Remainder("frequency", "a 3.00 Hz tone", 0.12),
    Remainder("time", "2 bursts", 0.04),
)


def diagnosis_by_hand(verdict: Any) -> Diagnosis:
    """A diagnosis with the given verdict; the numbers in its tables differ from one another."""
    has_effect = verdict in ("missing", "ambiguous")
    effects = ("sensor_offset",) if has_effect else ()
    before = comparison_by_hand(2.5, (2.0, 3.0))
    after = comparison_by_hand(0.525, (0.45, 0.6))
    tried = TRIALS if verdict != "adequate" else TRIALS[3:]
    bare = Step((), 2.5, 2.75, 0.5, tried)
    steps = (bare, Step(effects, 0.525, 0.55, 0.5)) if has_effect else (bare,)
    ties = ("sensor_drift",) if verdict == "ambiguous" else ()
    return Diagnosis(
        verdict=verdict,
        effects=effects,
        alternatives=dict.fromkeys(effects, ties),
        weights={e: {e: 0.62, **dict.fromkeys(ties, 0.38)} if ties else {e: 1.0} for e in effects},
        steps=steps,
        failures=before.failures if verdict != "adequate" else (),
        residual_structure=RESIDUAL_STRUCTURE if verdict == "unexplained" else (),
        next_experiment="record a rest" if ties else None,
        fit=replace(fit_by_hand(effects), noise=WHITE),
        before=before,
        after=after if has_effect else before,
        elapsed_s=12.5,
        level=Level.in_white_noise(DEFAULT, 12, 2000.0, 0.1),
        not_tried={"position_ripple": "not every run has the shaft's angle"},
        not_detectable=("backlash",) if verdict == "adequate" else (),
    )
