"""Models of each law and effect with equations for the targets without the core."""

import jbf
import numpy as np
from jbf.export.drive_equations import DRIVE
from jbf.export.equations import CONTACT, OTHER, TRANSMISSION
from jbf.models.catalogue import built_in, built_in_laws, reason_not_applicable
from joint_runs import JOINT, joint_runs

BASE = {"F_c": 5.0, "F_s": 8.0, "v_s": 0.1, "F_v": 2.0, "sigma_0": 2e3, "sigma_1": 3.0, "v_d": 0.3}
EFFECTS = ("presliding", *DRIVE, *CONTACT, *OTHER, *TRANSMISSION)


def model_of(law: str, *effects: str) -> jbf.Model:
    """Model of a law with effects, at typical values."""
    names = [e for name in effects for e in (name, built_in()[name].further_of) if e]
    values = {p.name: BASE.get(p.name, p.starts[0]) for p in built_in_laws()[law].parameters}
    for name in names:
        values |= {f"{name}.{p.name}": p.starts[0] for p in built_in()[name].parameters}
    return jbf.Model(JOINT, law, names, values)


def model_with(effect: str) -> jbf.Model:
    """Model with an effect, of the first law that it applies to."""
    laws = ("coulomb", "lugre", "dahl")
    law = next(law for law in laws if reason_not_applicable(built_in()[effect], law) is None)
    others = ("gravity", "inertia") if effect == "torque_proportional" else ()
    return model_of(law, effect, *others)


def runs_with_all_columns(step_s: float) -> list[jbf.Run]:
    """Runs with a stop and a rest, a load and a temperature."""
    runs = []
    for run in joint_runs(step_s=step_s):
        t = run.time_s
        velocity = run.velocity * ((t < 4.0) | (t > 4.5))
        path = np.concatenate([[0.0], np.cumsum(0.5 * step_s * (velocity[1:] + velocity[:-1]))])
        columns = {"load_n": 20.0 + 5.0 * np.sin(t), "temperature_c": 30.0 + t}
        runs.append(jbf.Run.from_arrays(t, velocity, angle_rad=path, name=run.name, **columns))
    return runs


def models_with_many_effects(omitted: tuple[str, ...] = ()) -> list[jbf.Model]:
    """Few models that have each effect, except those that are omitted, at least once."""
    models, rest = [], [effect for effect in EFFECTS if effect not in omitted]
    for law in ("dahl", "coulomb", "lugre"):
        chosen = [e for e in rest if reason_not_applicable(built_in()[e], law) is None]
        if chosen:
            models.append(model_of(law, *chosen))
        rest = [e for e in rest if e not in chosen]
    assert not rest
    return models
