"""Friction of a simulated joint: dry level, damping polynomial, bristle or springs, cogging.

Simulators have no law of the catalogue but elements that add up. A model is brought to a sum of
the elements that a simulator has: with its own values where an element has the same equation, else
with values fitted to the model along its runs.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from jbf.errors import InputError
from jbf.export.joint_elements import (
    MOST_EVALUATIONS,
    Elements,
    JointForm,
    fit_form,
    with_polynomial,
)
from jbf.export.ledger import Status, Term
from jbf.export.reference import BODY, COGGING, Reference, force_of_effects, instrument
from jbf.models.catalogue import built_in
from jbf.models.model import Model

STIFF = 1e-5
"""Deflection of a bristle that represents a jump, as a share of the range of the runs."""
NEGLIGIBLE = 1e-6
"""Level of a bristle that carries the Stribeck part only, relative to that part."""
LEAST_LEVEL = 1e-6
"""Lower bound of F_c in the catalogue, in the force unit of the rig."""
SPRINGS_EXPONENT = 0.3
"""Value of the exponent of springs from which it is fitted to the law `elasto_plastic`."""

_ONE_LEVEL = "a joint has the same friction in both directions"
_NO_STATIC_LEVEL = "breakaway is at F_c, not at F_s"
_NO_POSITION = "the friction of a joint does not depend on the position"
_NOT_CARRIED = {
    "drive_compliance": "needs two joints with a spring",
    "backlash": "needs two joints with a limited range",
    "viscous_asymmetry": _ONE_LEVEL,
    "dry_asymmetry": _ONE_LEVEL,
    "stribeck_asymmetry": _ONE_LEVEL,
    "direction_asymmetry": _ONE_LEVEL,
    "position_ripple": _NO_POSITION,
    "pitch_ripple": _NO_POSITION,
    "pitch_ripple_2": _NO_POSITION,
    "zero_load_dependence": "a joint has no force in one direction",
}
"""Effects whose mean over a motion to and fro is zero, or that no element carries."""
_FITTED = (
    "running_in",
    "dwell_stiction",
    "stribeck_excess",
    "dry_load_dependence",
    "viscous_load_dependence",
    "dry_temperature_dependence",
    "viscous_temperature_dependence",
    "viscous_thinning",
    "stroke_dependence",
    "warm_up",
    "torque_proportional",
)
"""Effects whose mean along the runs is contained in fitted values."""


@dataclass(frozen=True)
class _Start:
    """Form of a law, and the values that a fit changes; none for an exact form."""

    form: JointForm
    free: tuple[str, ...] = ()
    exact: bool = False
    lost: str = ""
    excess: bool = False
    """Whether the bristle carries the effect `stribeck_excess`."""


@dataclass(frozen=True)
class _Carried:
    """Form of a model, and how its values were determined.

    Attributes
    ----------
    elements
        Elements of the target.
    form
        The form with its final values.
    fitted
        Effects whose mean along the runs is contained in fitted values.
    refitted
        Values of the form that were fitted, named as in `JointForm.value`.
    excess
        Whether the bristle carries the effect `stribeck_excess`.
    """

    elements: Elements
    form: JointForm
    fitted: Collection[str]
    refitted: Collection[str]
    excess: bool


def joint_form(reference: Reference, elements: Elements) -> tuple[JointForm, tuple[Term, ...]]:
    """Bring a model to the elements of a joint.

    Returns
    -------
    form : JointForm
        The elements with their values.
    terms : tuple of Term
        How each term of the model is carried. `how` and `values` of the law are empty: the target
        states them in its own names.

    Raises
    ------
    InputError
        The rig has a journal bearing, or its forces are voltages.
    """
    model = reference.model
    _check_rig(model)
    effects = set(model.effects)
    machine = set(model.effects) - set(instrument(model))
    fitted = [
        name
        for name in model.effects
        if name in _FITTED or (name in machine and name not in built_in())
    ]
    if "quadratic_drag" in effects and not elements.polynomial:
        fitted.append("quadratic_drag")
    cogging = tuple(n for n in COGGING if n in effects) if elements.cogging else ()
    target = reference.without(force_of_effects(model, COGGING, reference.motions))
    start = _with_excess(reference, _start(reference, elements), elements)
    if start.excess:
        fitted.remove("stribeck_excess")
    form = start.form
    if "coulomb_drag" in effects:
        form = replace(form, level=form.level + model.parameters["coulomb_drag.F_d"].value)
    if "quadratic_drag" in effects and elements.polynomial:
        form = replace(
            form, damping=(form.damping[0], model.parameters["quadratic_drag.c"].value, 0.0)
        )
    free, lost, exact, excess = start.free, start.lost, start.exact, start.excess
    if fitted:
        free = tuple(dict.fromkeys([*free, *_scales(form), "damping"]))
        exact = False
    if free:
        form, converged = fit_form(target, form, free)
        level = JointForm(1.0, (1.0, *form.damping[1:]))
        plain, plain_converged = fit_form(target, level, ("level", "damping"))
        if target.rms_error(plain.force(target)) < target.rms_error(form.force(target)):
            if form.bristle or form.springs:
                lost = "dry level and damping alone, whose error is smaller than with a bristle"
                exact = excess = False
            form, converged, free = plain, plain_converged, (*free, "level", "damping")
        if not converged:
            stopped = f"the fit stopped after {MOST_EVALUATIONS} iterations"
            lost = f"{lost}; {stopped}" if lost else stopped
    if "viscous_thinning" in effects and elements.polynomial:
        form, free = with_polynomial(target, form), (*free, "level", "damping", "polynomial")
    form = replace(form, cogging=cogging)
    carried = _Carried(elements, form, fitted, free, excess)
    terms = [Term(model.law, "exact" if exact else "approximate", lost)]
    for name in model.effects:
        terms.append(_effect_term(model, name, carried))
    return form, tuple(terms)


def _check_rig(model: Model) -> None:
    quantities = model.rig.quantities
    if quantities.motion == "bearing":
        raise InputError(
            problem="the rig is a journal bearing, and the targets of simulators describe a joint",
            remedy="export to table, or fit a law to a rig with [drive]",
        )
    if quantities.force not in ("N", "N m"):
        raise InputError(
            problem=f"the friction of the model is in {quantities.force}, not in N or N m",
            remedy="give the drive a torque or force constant and fit again",
        )


def _effect_term(model: Model, name: str, carried: _Carried) -> Term:
    if name in instrument(model):
        return Term(name, "external", "property of the recording")
    if name in BODY:
        return Term(name, "external", "mass, weight or spring of the simulated bodies")
    if name in COGGING:
        if carried.elements.cogging:
            return Term(name, "exact", "")
        return Term(name, "none", "the target has no force that is periodic in the position")
    if name == "stribeck_excess" and carried.excess:
        return Term(name, "approximate", "bristle without a level at high speed")
    if name in carried.fitted or name == "stribeck_excess":
        return Term(name, "approximate", "mean along the runs, part of the fitted values")
    if name in ("coulomb_drag", "quadratic_drag"):
        values = {"level"} if name == "coulomb_drag" else {"damping", "polynomial"}
        drag: Status = "approximate" if values & set(carried.refitted) else "exact"
        return Term(name, drag, "part of the dry level or of the damping")
    if name == "presliding":
        if carried.form.bristle:
            fitted = any(value.startswith("bristle.") for value in carried.refitted)
            status: Status = "approximate" if fitted else "exact"
            return Term(name, status, "stiffness of the bristle")
        return Term(name, "none", "the target has no bristle")
    return Term(name, "none", _NOT_CARRIED.get(name, "the target has no element for it"))


def _start(reference: Reference, elements: Elements) -> _Start:
    """Form of the law of a model, with its own values as far as an element has them."""
    model = reference.model
    p = {name: value.value for name, value in model.parameters.items()}
    sigma = p.get("presliding.sigma")
    damping = (p.get("F_v", 0.0), 0.0, 0.0)
    start = None
    if elements.bristle:
        start = _with_bristle(model, p, sigma, damping, reference)
        if start is not None and (start.exact or not elements.springs):
            return start
    if elements.springs and model.law in ("maxwell_slip", "dahl", "elasto_plastic"):
        springs = {
            "F_c": p["F_c"],
            "sigma_0": p["sigma_0"],
            "exponent": p.get("exponent", SPRINGS_EXPONENT),
        }
        form = JointForm(damping=damping, springs=springs)
        if model.law == "elasto_plastic":
            return _Start(form, ("springs.exponent", "springs.sigma_0"))
        return _Start(form, exact=model.law == "maxwell_slip")
    if start is not None:
        return start
    if model.law == "coulomb":
        lost = "" if elements.static_level else _lost_static_level(model)
        exact = sigma is None and not lost
        return _Start(
            JointForm(p["F_c"], damping), () if sigma is None else ("level",), exact, lost
        )
    speed = reference.pooled(reference.velocity)
    size = float(np.sqrt(np.mean(reference.pooled(reference.force) ** 2)))
    guess = JointForm(size, (0.1 * size / float(np.max(np.abs(speed))), 0.0, 0.0))
    return _Start(guess, ("level", "damping"), lost="a joint has no memory and no Stribeck curve")


def _lost_static_level(model: Model) -> str:
    """Loss of a form of the law `coulomb` without a static level; empty without a loss."""
    static, level = model.parameters["F_s"], model.parameters["F_c"].value
    return _NO_STATIC_LEVEL if static.value > level and not static.held else ""


def _with_bristle(
    model: Model,
    p: Mapping[str, float],
    sigma: float | None,
    damping: tuple[float, float, float],
    reference: Reference,
) -> _Start | None:
    """Form of a law with a LuGre bristle; None for a law that has no such form."""
    free: tuple[str, ...]
    law = model.law
    bristle = {"F_c": p.get("F_c", 0.0), "F_s": p.get("F_c", 0.0), "v_s": 1.0, "sigma_1": 0.0}
    if law == "coulomb" and sigma is not None:
        lost = _lost_static_level(model)
        own = {**bristle, "sigma_0": sigma}
        return _Start(JointForm(0.0, damping, own), exact=not lost, lost=lost)
    if law == "stribeck":
        own = {**bristle, "F_s": p["F_s"], "v_s": p["v_s"]}
        free = () if p["delta"] == 2.0 else ("bristle.F_s", "bristle.v_s")
        if sigma is not None:
            free = ("bristle.F_c", *free) if free else ()
            return _Start(JointForm(0.0, damping, {**own, "sigma_0": sigma}), free, not free)
        excess = p["F_s"] - p["F_c"]
        if excess <= 0.0:
            return None
        own = _excess_bristle(excess, p["v_s"], reference)
        lost = "the Stribeck part rises over a short distance after a reversal"
        return _Start(JointForm(p["F_c"], damping, own), free, lost=lost)
    if law == "lugre":
        own = {name: p[name] for name in ("F_c", "F_s", "v_s", "sigma_0", "sigma_1")}
        exact = p["sigma_1"] == 0.0 or p["v_d"] >= 10.0 * reference.top_speed
        lost = "" if exact else "sigma_1 does not decay with the speed"
        free = () if exact else ("bristle.sigma_1",)
        return _Start(JointForm(0.0, damping, own), free, exact, lost)
    if law in ("dahl", "maxwell_slip", "elasto_plastic"):
        own = {**bristle, "sigma_0": p["sigma_0"]}
        exact = law == "dahl" and p["exponent"] == 1.0
        lost = "" if exact else "another transition from sticking to sliding"
        free = () if exact else ("bristle.sigma_0",)
        return _Start(JointForm(0.0, damping, own), free, exact, lost)
    if law == "seven_parameter":
        own = {**bristle, "F_s": p["F_c"] + p["F_s_inf"], "v_s": p["v_s"], "sigma_0": p["k_t"]}
        free = ("bristle.F_c", "bristle.F_s", "bristle.v_s")
        lost = "no delay, and no dependence on the time at rest"
        return _Start(JointForm(0.0, damping, own), free, lost=lost)
    return None


def _with_excess(reference: Reference, start: _Start, elements: Elements) -> _Start:
    """Add a bristle for `stribeck_excess` to a form without one."""
    model, form = reference.model, start.form
    if "stribeck_excess" not in model.effects or not elements.bristle:
        return start
    if form.bristle or form.springs or start.free:
        return start
    a, v_s, n = (model.parameters[f"stribeck_excess.{x}"].value for x in ("a", "v_s", "n"))
    if a <= 0.0:
        return start
    bristle = _excess_bristle(a, v_s, reference)
    free = () if n == 2.0 else ("bristle.F_s", "bristle.v_s")
    return replace(start, form=replace(form, bristle=bristle), free=free, excess=True)


def _excess_bristle(excess: float, v_s: float, reference: Reference) -> dict[str, float]:
    """Stiff bristle that carries the Stribeck part of a friction only."""
    return {
        "F_c": max(NEGLIGIBLE * excess, LEAST_LEVEL),
        "F_s": excess,
        "v_s": v_s,
        "sigma_0": excess / (STIFF * reference.travel),
        "sigma_1": 0.0,
    }


def _scales(form: JointForm) -> tuple[str, ...]:
    """Values of a form that set the size of the dry friction."""
    names = []
    if form.level:
        names.append("level")
    if form.bristle and not (form.level and form.bristle["F_c"] < form.level):
        names += ["bristle.F_c", "bristle.F_s"]
    elif form.bristle:
        names.append("bristle.F_s")
    return (*names, "springs.F_c") if form.springs else tuple(names)
