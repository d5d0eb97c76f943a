"""Equations of a model as functions, independent of the language in which they are written."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass

from jbf import _core
from jbf.export.equations import (
    CONTACT,
    FUNCTIONS,
    LAWS,
    OTHER,
    PRESLIDING,
    TRANSMISSION,
    LawEquations,
)
from jbf.export.step_equations import BRISTLES, RIGID, SLOPES, STEP
from jbf.models.model import Model

MOTION = ("velocity", "acceleration", "position", "weight_offset", "load", "temperature")
"""Fields of a motion, without its time."""
KNOWN = {*CONTACT, *OTHER, *TRANSMISSION, "presliding"}
"""Effects with equations."""
Value = float | tuple[float, ...]


@dataclass(frozen=True)
class Program:
    """Functions of a model, and the constants that they use.

    Attributes
    ----------
    functions
        Functions in an order in which each is defined before its use.
    constants
        Values of the constants by name.
    states
        Number of bristles, at least 1.
    inputs
        Fields of the motion that the force depends on, without the time.
    """

    functions: tuple[ast.FunctionDef, ...]
    constants: Mapping[str, Value]
    states: int
    inputs: tuple[str, ...]


def law_equations(model: Model) -> tuple[LawEquations, LawEquations]:
    """Equations of the law of a model, and those of its bristles."""
    law = LAWS[model.law]
    return law, PRESLIDING if "presliding" in model.effects else law


def equations(model: Model, compensated: bool) -> dict[str, list[ast.stmt]]:
    """Statements of a model by the placeholder that they replace.

    `compensated` adds the part of the force that jumps to the state, for a compensator.
    """
    law, bristles = law_equations(model)

    def of_effects(stage: Mapping[str, str]) -> str:
        return "\n".join(stage[name] for name in model.effects if name in stage)

    texts = {
        "friction_of_law": law.friction,
        "contact": of_effects(CONTACT),
        "other": of_effects(OTHER),
        "transmission": of_effects(TRANSMISSION),
        "force_of_contact": BRISTLES if bristles.states else RIGID,
        "bend": bristles.bend,
        "start_of_bristles": bristles.start,
        "slope_of_bristles": bristles.slope,
        "force_of_bristles": bristles.force if bristles.states else RIGID,
        "jump_of_force": f"state.jump = {'drag' if bristles.states else 'level + drag'}"
        if compensated
        else "",
        "rest": "state.resting = state.velocity == 0.0 and place.velocity == 0.0"
        if model.law == "coulomb"
        else "",
    }
    return {name: ast.parse(text).body for name, text in texts.items()}


def program(
    model: Model,
    roots: tuple[str, ...] = ("start", "step"),
    added: tuple[str, Mapping[str, Value]] | None = None,
) -> Program:
    """Compose the functions of a model.

    Parameters
    ----------
    model
        The model, of a law and effects with equations.
    roots
        Functions that the user calls: `start`, `step`, `slopes`, `settled`.
    added
        Text of the functions of a compensator, and their constants.
    """
    law, bristles = law_equations(model)
    text = "\n".join(
        [FUNCTIONS, STEP, SLOPES if "slopes" in roots else "", added[0] if added else ""]
    )
    tree = ast.parse(text.replace("inner_steps()", _inner_steps(law, bristles)))
    tree = _Completed(equations(model, added is not None)).visit(tree)
    available = {f.name: _without_unused(f) for f in tree.body if isinstance(f, ast.FunctionDef)}
    functions = tuple(_reachable(available, roots))
    known = {**constants_of(model), **(added[1] if added else {})}
    used = {node.id for f in functions for node in ast.walk(f) if isinstance(node, ast.Name)}
    constants = {name: value for name, value in known.items() if name in used}
    forces = [f for f in functions if f.name in ("act", "slopes", "settled")]
    read = {n.attr for f in forces for n in ast.walk(f) if isinstance(n, ast.Attribute)}
    inputs = tuple(name for name in MOTION if name == "velocity" or name in read)
    return Program(functions, constants, max(bristles.states, 1), inputs)


def constants_of(model: Model) -> dict[str, Value]:
    """Constants of the equations by name: parameters, and the springs of `maxwell_slip`."""
    values: dict[str, Value] = {
        name.replace(".", "_"): value.value for name, value in model.parameters.items()
    }
    if model.law == "maxwell_slip":
        names = ("sigma_0", "exponent", "F_v")
        springs = _core.maxwell_slip_elements([1.0, *(model.parameters[n].value for n in names)])
        stiffness, share = zip(*springs, strict=True)
        values |= {"spring_stiffness": stiffness, "spring_share": share}
    return values


def _inner_steps(law: LawEquations, bristles: LawEquations) -> str:
    """Expression for the number of inner steps of a sample."""
    longest = [x.longest_step_s for x in (law, bristles) if x.longest_step_s > 0.0]
    if not longest:
        return "1.0"
    step = repr(min(longest))
    if law.steps_per_sample:
        step = f"max({step}, sample_s * {1.0 / law.steps_per_sample!r})"
    return f"min(max(ceil(dt_s / {step} - 1e-9), 1.0), 1e6)"


class _Completed(ast.NodeTransformer):
    """Replaces placeholders by statements, and names by fields of motion and state."""

    def __init__(self, statements: Mapping[str, list[ast.stmt]]) -> None:
        self.statements = statements

    def visit_Expr(self, node: ast.Expr) -> ast.AST | list[ast.AST]:
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and not call.args:
            done: list[ast.AST] = []
            for statement in self.statements[call.func.id]:
                new = self.visit(_Fields().visit(ast.parse(ast.unparse(statement)).body[0]))
                done.extend(new if isinstance(new, list) else [new])
            return done
        return node


class _Fields(ast.NodeTransformer):
    """Replaces names of the equations by fields of `motion` and `state`."""

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in MOTION:
            return _field("motion", node.id, node.ctx)
        fields = {"y": "bristle", "slope": "slope", "resting": "resting"}
        if node.id in fields:
            return _field("state", fields[node.id], node.ctx)
        return node


def _field(struct: str, name: str, ctx: ast.expr_context) -> ast.Attribute:
    return ast.Attribute(ast.Name(struct, ast.Load()), name, ctx)


def _without_unused(function: ast.FunctionDef) -> ast.FunctionDef:
    """Remove assignments to local names that nothing reads."""
    while True:
        read = {
            node.id
            for node in ast.walk(function)
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
        }
        before = ast.dump(function)
        function = _Unused(read).visit(function)
        if ast.dump(function) == before:
            return function


class _Unused(ast.NodeTransformer):
    def __init__(self, read: set[str]) -> None:
        self.read = read

    def _kept(self, node: ast.Assign | ast.AugAssign) -> ast.stmt | None:
        target = node.targets[0] if isinstance(node, ast.Assign) else node.target
        unread = isinstance(target, ast.Name) and target.id not in self.read
        return None if unread else node

    def visit_If(self, node: ast.If) -> ast.stmt | None:
        self.generic_visit(node)
        return node if node.body or node.orelse else None

    visit_Assign = visit_AugAssign = _kept


def _reachable(
    available: Mapping[str, ast.FunctionDef], roots: tuple[str, ...]
) -> list[ast.FunctionDef]:
    """Functions that the roots call, callees first."""
    order: list[str] = []

    def add(name: str) -> None:
        if name in order:
            return
        for node in ast.walk(available[name]):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                called = node.func.id
                if called in available:
                    add(called)
        order.append(name)

    for root in roots:
        add(root)
    return [available[name] for name in order]
