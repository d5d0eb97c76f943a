"""Equations of a model as functions, independent of the language in which they are written."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass

from jbf.export import drive_equations, memory_equations
from jbf.export.drive_equations import DIRECTION, DRIVE, INERTIA_WITH_SPRING, RESIST
from jbf.export.equations import (
    CONTACT,
    FUNCTIONS,
    LAWS,
    OTHER,
    PRESLIDING,
    TRANSMISSION,
    LawEquations,
    Value,
)
from jbf.export.memory_equations import MEMORY, Memory
from jbf.export.step_equations import BRISTLES, LEGS, ONE_LEG, RIGID, SLOPES, STEP
from jbf.models.catalogue import built_in
from jbf.models.chain import MAX_STEP_S
from jbf.models.model import Model

MOTION = ("velocity", "acceleration", "position", "weight_offset", "load", "temperature")
"""Fields of a motion, without its time."""
KNOWN = {*DRIVE, *CONTACT, *OTHER, *TRANSMISSION, "presliding"}
"""Effects with equations."""
STATES = {**DRIVE, **MEMORY}
"""States of laws and effects by name."""
SOLVED = ("slopes", "settled")
"""Functions for a solver of differential equations."""


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
    memory
        Types of the states that are not bristles by name: type, and length of an array or zero.
    rates
        For a solver: initial value and time derivative of these states by name.
    """

    functions: tuple[ast.FunctionDef, ...]
    constants: Mapping[str, Value]
    states: int
    inputs: tuple[str, ...]
    memory: Mapping[str, tuple[str, int]]
    rates: Mapping[str, tuple[ast.expr, ast.expr]]


def memories(model: Model) -> list[Memory]:
    """States of the law and the effects of a model that are advanced before the friction."""
    return [STATES[name] for name in (model.law, *model.effects) if name in STATES]


def law_equations(model: Model) -> tuple[LawEquations, LawEquations]:
    """Equations of the law of a model, and those of its bristles."""
    law = LAWS[model.law]
    return law, PRESLIDING if "presliding" in model.effects else law


def equations(model: Model, compensated: bool, stepped: bool) -> dict[str, list[ast.stmt]]:
    """Statements of a model by the placeholder that they replace.

    `compensated` adds the part of the force that jumps to the state, for a compensator. `stepped`
    adds the time derivatives of states that are not bristles, for code that also has steps.
    """
    law, bristles = law_equations(model)

    def of_effects(stage: Mapping[str, str]) -> str:
        return "\n".join(stage[name] for name in model.effects if name in stage)

    driven = [name for name in model.effects if name in DRIVE]
    other = OTHER
    if "drive_compliance" in driven:
        other = OTHER | {"inertia": INERTIA_WITH_SPRING}
    drive = [
        "state.direction = sign(place.velocity)",
        *(f"{name}_step(state, place, dt_s / steps)" for name in driven),
    ]
    texts = {
        "drive": "\n".join(drive) if driven else "",
        "direction_of_motion": DIRECTION if driven else "direction = sign(v)",
        "resistance": RESIST if "drive_compliance" in driven else "",
        "friction_of_law": law.friction,
        "contact": of_effects(CONTACT),
        "other": of_effects(other),
        "transmission": of_effects(TRANSMISSION),
        "force_of_contact": BRISTLES if bristles.states else RIGID,
        "legs": LEGS if driven else ONE_LEG,
        "one_leg": ONE_LEG,
        "bend": bristles.bend,
        "start_of_bristles": bristles.start,
        "slope_of_bristles": bristles.slope,
        "force_of_bristles": bristles.force if bristles.states else RIGID,
        "start_of_memory": "\n".join(memory.start for memory in memories(model)),
        "advance_memory": "\n".join(memory.advance for memory in memories(model)),
        "rates": "\n".join(
            f"{name}_rate = {rate}"
            for memory in memories(model)
            for name, (_, rate) in memory.rates.items()
            if stepped
        ),
        "jump_of_force": f"state.jump = {'drag' if bristles.states else 'level + drag'}"
        if compensated
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
    _, bristles = law_equations(model)
    solver = SLOPES if "slopes" in roots else ""
    text = "\n".join(
        [
            FUNCTIONS,
            memory_equations.FUNCTIONS,
            drive_equations.FUNCTIONS,
            STEP,
            solver,
            added[0] if added else "",
        ]
    )
    tree = ast.parse(text.replace("inner_steps()", _inner_steps(model)))
    fields = _Fields(memories(model))
    tree = _Completed(equations(model, added is not None, "step" in roots), fields).visit(tree)
    available = {f.name: _without_unused(f) for f in tree.body if isinstance(f, ast.FunctionDef)}
    functions = tuple(_reachable(available, roots))
    known = {**constants_of(model), **(added[1] if added else {})}
    rates = _rates(model, fields) if solver else {}
    trees = (*functions, *(part for parts in rates.values() for part in parts))
    used = {node.id for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Name)}
    constants = {name: value for name, value in known.items() if name in used}
    forces = [f for f in functions if f.name in ("act", "slopes", "settled")]
    read = {n.attr for f in forces for n in ast.walk(f) if isinstance(n, ast.Attribute)}
    inputs = tuple(name for name in MOTION if name == "velocity" or name in read)
    variables = {n: _type(t) for memory in memories(model) for n, t in memory.variables.items()}
    if solver and "step" in roots:
        variables |= {f"{name}_rate": ("real", 0) for name in rates}
    if any(name in DRIVE for name in model.effects):
        variables["direction"] = ("real", 0)
    return Program(functions, constants, max(bristles.states, 1), inputs, variables, rates)


def constants_of(model: Model) -> dict[str, Value]:
    """Constants of the equations by name: the parameters, and those that the law computes."""
    values = {name.replace(".", "_"): value.value for name, value in model.parameters.items()}
    return {**values, **LAWS[model.law].constants(values)}


def _type(text: str) -> tuple[str, int]:
    """Type of a state, and the length of an array or zero."""
    kind, _, length = text.rstrip("]").partition("[")
    return kind, int(length or 0)


def _rates(model: Model, fields: _Fields) -> dict[str, tuple[ast.expr, ast.expr]]:
    """Initial values and time derivatives of the states of a model, for a solver."""
    motion = _field("motion", "velocity", ast.Load())

    def expression(text: str) -> ast.expr:
        tree = fields.visit(ast.parse(text, mode="eval").body)
        result = _Replaced({"v": motion}).visit(tree)
        assert isinstance(result, ast.expr)
        return result

    return {
        name: (expression(start), expression(rate))
        for memory in memories(model)
        for name, (start, rate) in memory.rates.items()
    }


def _inner_steps(model: Model) -> str:
    """Expression for the number of inner steps of a sample."""
    law, bristles = law_equations(model)
    effects_remember = any(name in STATES for name in model.effects)
    if not law.longest_step_s and not bristles.states and not effects_remember:
        return "1.0"
    longest = min([MAX_STEP_S, *(built_in()[name].longest_step_s for name in model.effects)])
    step = repr(min(longest, law.longest_step_s or longest))
    if law.steps_per_sample:
        enough = f"sample_s * {1.0 / law.steps_per_sample!r}"
        step = f"min({longest!r}, max({law.longest_step_s!r}, {enough}))"
    return f"min(max(ceil(dt_s / {step} - 1e-9), 1.0), 1e6)"


class _Completed(ast.NodeTransformer):
    """Replaces placeholders by statements, and names by fields of motion and state."""

    def __init__(self, statements: Mapping[str, list[ast.stmt]], fields: _Fields) -> None:
        self.statements = statements
        self.fields = fields

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self.fields.solved = node.name in SOLVED
        return self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> ast.AST | list[ast.AST]:
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and not call.args:
            done: list[ast.AST] = []
            for statement in self.statements[call.func.id]:
                new = self.visit(self.fields.visit(ast.parse(ast.unparse(statement)).body[0]))
                done.extend(new if isinstance(new, list) else [new])
            return done
        return node


class _Fields(ast.NodeTransformer):
    """Replaces names of the equations by fields of `motion` and `state`.

    In functions for a solver, states without a derivative have the value of `Memory.fixed`.
    """

    def __init__(self, states: list[Memory]) -> None:
        names = [name for memory in states for name in memory.variables]
        names += [f"{name}_rate" for memory in states for name in memory.rates]
        self.names = {"y": "bristle", "slope": "slope"} | {name: name for name in names}
        self.fixed = {name: value for memory in states for name, value in memory.fixed.items()}
        self.solved = False

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in MOTION:
            return _field("motion", node.id, node.ctx)
        if self.solved and node.id in self.fixed:
            return ast.parse(self.fixed[node.id], mode="eval").body
        if node.id in self.names:
            return _field("state", self.names[node.id], node.ctx)
        return node


class _Replaced(ast.NodeTransformer):
    """Replaces names by expressions."""

    def __init__(self, values: Mapping[str, ast.expr]) -> None:
        self.values = values

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self.values.get(node.id, node)


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
