"""Robustness of a compensator against errors of its model.

Every effect of the catalogue is added to the plant, one at a time, while the compensator uses the
base law. An effect of the instrument does not act on the shaft; it is added to the records to which
the law is fitted. Further cases are a wrong load, viscosity, friction and motor, and more noise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from jbf.control.bench import THESIS_BENCH, Bench, thesis_model, with_noise
from jbf.control.run import run
from jbf.control.schemes import NoCompensation, Observed, Scheme
from jbf.control.task import TASKS, Task
from jbf.control.tuning import tune
from jbf.estimation.fit import fit
from jbf.models.catalogue import effects, laws, reason_not_applicable
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.models.user_effects import UserEffect
from jbf.records.rig import Lubricant
from jbf.records.run import Run

Report = Callable[[str, int, int], None]

HELP, HARM = 0.95, 1.02
"""Ratios of the errors with and without compensation below or above which it helps or harms.

Compensation helps below `HELP`, harms above `HARM`, and is neutral between them.
"""

STRONG: Mapping[str, Mapping[str, float]] = {
    "drive_compliance": {"k": 60.0, "c": 0.02, "J": 1e-3},
    "thermal_thinning": {"beta_q_1_j": 0.3, "tau_s": 60.0},
    "shear_thinning": {"U_c_m_s": 0.05},
    "film_memory": {"factor": 0.3},
    "presliding": {"sigma": 5e3},
    "dwell_stiction": {"a": 0.1, "t_0_s": 1.0},
    "stribeck_excess": {"a": 0.1, "v_s": 0.005},
    "direction_asymmetry": {"a": 0.3},
    "position_ripple": {"a": 0.3},
    "running_in": {"a": 0.5, "s_0": 0.2},
    "coulomb_drag": {"F_d": 10.0},
    "quadratic_drag": {"c": 200.0},
    "inertia": {"m_e": 2.0},
    "sensor_offset": {"b": 5.0},
}
"""Parameters of the effects added to the plant, which change friction by tens of percent.

Effects that are not listed have the catalogue's first starting value.
"""

_SECONDS = 27.0

_FIT_SPEED_M_S = 0.1


@dataclass(frozen=True)
class Case:
    """Plant that differs from the model of the compensator.

    Attributes
    ----------
    name
        Description of the difference.
    plant, bench
        True friction, and bench.
    load_factor
        Factor on the load of the plant.
    """

    name: str
    plant: Model
    bench: Bench
    load_factor: float = 1.0
    carried: Model | None = None
    """Model used by the compensator, if it is not the base model of all cases."""


@dataclass(frozen=True)
class Outcome:
    """Effect of compensation on the true error of a case.

    Attributes
    ----------
    name
        Name of the case.
    ratios
        RMS of the true error with compensation divided by that without it, by task.
    """

    name: str
    ratios: Mapping[str, float]

    @property
    def worst(self) -> float:
        """Largest ratio of errors over all tasks."""
        return max(self.ratios.values())

    @property
    def verdict(self) -> str:
        """`help`, `neutral` or `harm`, according to the largest ratio of errors."""
        return "help" if self.worst < HELP else "neutral" if self.worst <= HARM else "harm"


def cases(base: Model, bench: Bench = THESIS_BENCH) -> Iterator[Case]:
    """Yield every case in which the compensator's model differs from the plant."""
    for name, page in effects().items():
        user_defined = isinstance(page, UserEffect)
        if (
            user_defined
            or reason_not_applicable(page, base.law) is not None
            or name in base.effects
        ):
            continue
        strong = STRONG.get(name, {})
        names = {p.name for p in page.parameters}
        values = {
            f"{name}.{p.name}": ParameterValue(strong.get(p.name, p.starts[0]))
            for p in page.parameters
        }
        assert set(strong) <= names, f"{name} has no {set(strong) - names}"
        plant = replace(
            base, effects=(*base.effects, name), parameters={**base.parameters, **values}
        )
        if page.stage == "instrument":
            yield Case(f"hidden {name}", base, bench, carried=fit_to_simulated_records(base, plant))
            continue
        # An effect of the load is observable only under a load that differs from that of the rig.
        yield Case(f"hidden {name}", plant, bench, 1.5 if "loads" in page.needs else 1.0)
    yield Case("load doubled", base, bench, 2.0)
    yield Case("load halved", base, bench, 0.5)
    if base.rig.lubricant is not None and laws()[base.law].has_film:
        for word, factor in (("doubled", 2.0), ("halved", 0.5)):
            oil = Lubricant(base.rig.lubricant.viscosity_pa_s * factor)
            yield Case(
                f"viscosity {word}", replace(base, rig=replace(base.rig, lubricant=oil)), bench
            )
    for word, factor in (("50 % larger", 1.5), ("33 % smaller", 1.0 / 1.5)):
        stronger = replace(bench, volts_per_n=bench.volts_per_n * factor)
        yield Case(f"friction {word}", base, stronger)
    # The position law itself becomes unstable at a gain 17 % above the nominal one.
    for word, factor in (("10 % larger", 1.1), ("10 % smaller", 0.9)):
        motor = replace(bench, input_rad_s2_v=bench.input_rad_s2_v * factor)
        yield Case(f"motor gain {word}", base, motor)
    yield Case("noise quadrupled", base, with_noise(bench, 4.0))


def fit_to_simulated_records(base: Model, true_model: Model) -> Model:
    """Fit the base model to records simulated by `true_model` with 2 % noise."""
    rng = np.random.default_rng(1)
    runs = []
    for i, rate in enumerate((0.25, 1.0)):
        time_s = np.arange(0.0, 4.0 * np.pi / rate, 0.02)
        speed = _FIT_SPEED_M_S * np.sin(rate * time_s)
        path_m = _FIT_SPEED_M_S / rate * (1.0 - np.cos(rate * time_s))
        bearing = base.rig.bearing
        angle = None if bearing is None else path_m / bearing.radius_m
        clean = Run(f"run {i}", time_s, speed, angle_rad=angle, position_m=path_m)
        friction = true_model.predict(clean)
        noise = rng.normal(0.0, 0.02 * float(np.max(np.abs(friction))), len(friction))
        runs.append(replace(clean, friction=friction + noise))
    start = {n: p.value for n, p in base.parameters.items()}
    fitted = fit(base.rig, runs, base.effects, law=base.law, clock=base.clock, start=start)
    return fitted.model


def robustness(
    base: Model | None = None,
    bench: Bench = THESIS_BENCH,
    tasks: Mapping[str, Task] = TASKS,
    *,
    scheme: Scheme | None = None,
    report: Report | None = None,
) -> list[Outcome]:
    """Compute the effect of compensation on the error for every case of a wrong model.

    `scheme` replaces the observed compensator. The compensator uses the model `base`. Scheme and
    control law know only the undisturbed bench.
    """
    model = thesis_model(elastic="nothing") if base is None else base
    todo = list(cases(model, bench))

    def judge(case: Case) -> Outcome:
        """Simulate all tasks of a case with and without compensation."""
        carried = model if case.carried is None else case.carried
        given = Observed(carried, tune(carried, bench)) if scheme is None else scheme
        ratios = {}
        for row, task in tasks.items():
            short_task = replace(task, seconds=_SECONDS + task.skip_s)
            load = None
            if case.plant.rig.load is not None:
                load = case.plant.rig.load.normal_n * case.load_factor
            errors = [
                run(
                    case.plant, s, short_task, bench=case.bench, assumed=bench, load_n=load
                ).true_rms
                for s in (NoCompensation(), given)
            ]
            ratios[row] = errors[1] / errors[0]
        return Outcome(case.name, ratios)

    outcomes = []
    with ThreadPoolExecutor() as pool:
        for i, outcome in enumerate(pool.map(judge, todo)):
            outcomes.append(outcome)
            if report is not None:
                report("robustness", i + 1, len(todo))
    return outcomes
