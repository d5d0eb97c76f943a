"""Elements of a simulated joint that add up to its friction, and the fit of their values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jbf.arrays import Array
from jbf.export.reference import Reference, force_of_effects
from jbf.models.model import Model

MOST_CHANGE = 8.0
"""Largest change of the logarithm of a fitted value, a factor of about 3000."""
MOST_EVALUATIONS = 40
"""Largest number of iterations of a fit of a form."""
DIFFERENCE = 1e-4
"""Relative step of the numerical derivatives of a fit; the forces of springs are not smooth."""
UNDAMPED_SPEED = 1e3
"""Speed v_d of the law `lugre` at which sigma_1 does not decay."""


@dataclass(frozen=True)
class Elements:
    """Elements of a joint that a simulator has.

    Attributes
    ----------
    polynomial
        Damping with quadratic and cubic terms.
    bristle
        LuGre bristle with a Stribeck curve.
    springs
        Parallel springs that yield.
    cogging
        Force that is periodic in the position.
    static_level
        Level at rest above the dry level of sliding.
    """

    polynomial: bool = False
    bristle: bool = False
    springs: bool = False
    cogging: bool = False
    static_level: bool = False


@dataclass(frozen=True)
class JointForm:
    """Sum of the elements of a simulated joint.

    Attributes
    ----------
    level
        Dry friction, the same in both directions, in the force unit of the rig (N or N m).
    damping
        Coefficients of v, v |v| and v^3; that of v in N s/m or N m s/rad, the others per further
        m/s or rad/s.
    bristle
        Parameters F_c and F_s (N or N m), v_s (m/s or rad/s), sigma_0 (N/m or N m/rad) and sigma_1
        (N s/m or N m s/rad) of a LuGre bristle; empty without one.
    springs
        Parameters F_c (N or N m), sigma_0 (N/m or N m/rad) and exponent of sixteen springs that
        yield (law `maxwell_slip`); empty without them.
    cogging
        Effects of the model that are carried as cogging.
    """

    level: float = 0.0
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    bristle: Mapping[str, float] = field(default_factory=dict)
    springs: Mapping[str, float] = field(default_factory=dict)
    cogging: tuple[str, ...] = ()

    def force(self, reference: Reference) -> list[Array]:
        """Force along the runs of a reference, N or N m, each shape (n,)."""
        force = [
            self.level * np.sign(v) + v * np.polyval(self.damping[::-1], np.abs(v))
            for v in reference.velocity
        ]
        rig = reference.model.rig
        models = []
        if self.bristle:
            values = {**self.bristle, "v_d": UNDAMPED_SPEED, "F_v": 0.0}
            models.append(Model(rig, "lugre", parameters=values))
        if self.springs:
            models.append(Model(rig, "maxwell_slip", parameters={**self.springs, "F_v": 0.0}))
        parts = [reference.predict(model) for model in models]
        if self.cogging:
            parts.append(force_of_effects(reference.model, self.cogging, reference.motions))
        for part in parts:
            force = [a + b for a, b in zip(force, part, strict=True)]
        return force

    def value(self, name: str) -> float:
        """Value of `level`, `damping`, or of a parameter such as `bristle.F_c`."""
        element, _, parameter = name.partition(".")
        if element == "level":
            return self.level
        if element == "damping":
            return self.damping[0]
        return (self.bristle if element == "bristle" else self.springs)[parameter]

    def with_values(self, values: Mapping[str, float]) -> JointForm:
        """Return the form with other values, named as in `value`."""
        form = self
        for name, value in values.items():
            element, _, parameter = name.partition(".")
            if element == "damping":
                form = replace(form, damping=(value, *form.damping[1:]))
            elif element == "level":
                form = replace(form, level=value)
            elif element == "bristle":
                form = replace(form, bristle={**form.bristle, parameter: value})
            else:
                form = replace(form, springs={**form.springs, parameter: value})
        return form


def with_polynomial(reference: Reference, form: JointForm) -> JointForm:
    """Fit dry level and damping polynomial of a form to the force of a reference.

    The result is dissipative at every speed. A form without a dry level keeps none.
    """
    from scipy.optimize import nnls  # a large part of the import time of jbf.export

    rest = replace(form, level=0.0, damping=(0.0, 0.0, 0.0)).force(reference)
    force = reference.pooled(a - b for a, b in zip(reference.force, rest, strict=True))
    v = reference.pooled(reference.velocity)
    dry = np.sign(v) * (form.level > 0.0)
    columns = np.stack([dry, v, v * np.abs(v), v**3], axis=1)
    level, a, b, c = (float(x) for x in np.linalg.lstsq(columns, force, rcond=None)[0])
    if min(level, a, c) < 0.0 or b < -2.0 * np.sqrt(a * c):
        level, a, b, c = (float(x) for x in nnls(columns, force)[0])
    return replace(form, level=level, damping=(a, b, c))


def fit_form(
    reference: Reference, form: JointForm, free: tuple[str, ...]
) -> tuple[JointForm, bool]:
    """Fit values of a form to the force of a reference, by least squares; none becomes negative.

    Positive values are fitted by their logarithm; the damping and a value that starts at zero are
    fitted linearly. A static level stays below the largest dry force: runs with few samples near
    the Stribeck velocity do not determine a larger one.

    Returns
    -------
    form : JointForm
        The form with the fitted values.
    converged : bool
        Whether the fit converged within `MOST_EVALUATIONS` iterations.
    """
    from scipy.optimize import least_squares

    size = reference.friction_rms
    unit = dict.fromkeys(free, size)
    unit["damping"] = size / reference.top_speed
    linear = {name for name in free if name == "damping" or form.value(name) <= 0.0}
    if "bristle.sigma_1" in linear:
        unit["bristle.sigma_1"] = size / reference.top_speed

    def values(x: Array) -> dict[str, float]:
        return {
            name: float(unit[name] * s if name in linear else form.value(name) * np.exp(s))
            for name, s in zip(free, x, strict=True)
        }

    def residual(x: Array) -> Array:
        errors = zip(form.with_values(values(x)).force(reference), reference.force, strict=True)
        return reference.pooled(a - b for a, b in errors) / size

    begin = [form.value(name) / unit[name] if name in linear else 0.0 for name in free]
    bounds = [(0.0, np.inf) if name in linear else (-MOST_CHANGE, MOST_CHANGE) for name in free]
    lower, upper = np.array(bounds).T
    viscous = [form.damping[0] * v for v in reference.velocity]
    dry = (np.abs(a - b) for a, b in zip(reference.force, viscous, strict=True))
    largest = max(float(np.max(force)) for force in dry)
    for i, name in enumerate(free):
        if name == "bristle.F_s" and name not in linear:
            upper[i] = max(np.log(largest / form.value(name)), 1e-6)
    start = np.clip(begin, lower + 1e-9, None)
    solution = least_squares(
        residual,
        start,
        bounds=(lower, upper),
        diff_step=[DIFFERENCE],
        max_nfev=MOST_EVALUATIONS,
    )
    return form.with_values(values(solution.x)), solution.status > 0
