"""Possible mutants of the source of a package, from the operators of cosmic-ray."""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosmic_ray.mutating import MutationVisitor
from cosmic_ray.operators.provider import OperatorProvider
from parso.grammar import load_grammar
from parso.tree import BaseNode, NodeOrLeaf

PREFIX = {"binary": "ReplaceBinaryOperator_", "comparison": "ReplaceComparisonOperator_"}
BINARY = ("Add_Sub", "Sub_Add", "Mul_Div", "Div_Mul", "FloorDiv_Mul", "Mod_Mul", "Pow_Mul")
SETS = ("BitAnd_BitOr", "BitOr_BitAnd", "BitXor_BitAnd")
ORDER = ("Lt_LtE", "Lt_GtE", "LtE_Lt", "LtE_Gt", "Gt_GtE", "Gt_LtE", "GtE_Gt", "GtE_Lt")
SAME = ("Eq_NotEq", "NotEq_Eq", "Is_IsNot", "IsNot_Is")
OPERATORS = (
    *(PREFIX["binary"] + pair for pair in BINARY + SETS),
    *(PREFIX["comparison"] + pair for pair in ORDER + SAME),
    *(f"ReplaceUnaryOperator_Delete_{name}" for name in ("USub", "Not", "Invert")),
    "AddNot",
    "ReplaceTrueWithFalse",
    "ReplaceFalseWithTrue",
    "ReplaceAndWithOr",
    "ReplaceOrWithAnd",
    "ReplaceBreakWithContinue",
    "ReplaceContinueWithBreak",
    "ExceptionReplacer",
    "NumberReplacer",
    "RemoveDecorator",
    "ZeroIterationForLoop",
)
"""The operators of cosmic-ray whose mutants can run.

Mutants such as `a >> b` of two floats always fail and would inflate the rate.
"""


@dataclass(frozen=True)
class Fault:
    """Mutant: the `occurrence`-th site of an operator in a file."""

    file: str
    line: int
    column: int
    operator: str
    occurrence: int

    @property
    def name(self) -> str:
        """Name of the mutant: file, position, operator and occurrence."""
        return f"{self.file}:{self.line}:{self.column} {self.operator} {self.occurrence}"

    def applied(self, source: str) -> str:
        """Return the source with the mutant inserted."""
        made = MutationVisitor.mutate_code(source, _operator(self.operator), self.occurrence)
        if made is None:
            raise ValueError(f"{self.name} has no place")
        return str(made)


def _operator(name: str) -> Any:
    return OperatorProvider()[name]()


def _nodes(node: NodeOrLeaf) -> Iterator[NodeOrLeaf]:
    yield node
    if isinstance(node, BaseNode):
        for child in node.children:
            yield from _nodes(child)


def _is_for_types(node: NodeOrLeaf) -> bool:
    """Return True if a node is in an annotation or under `if TYPE_CHECKING`, and is never run."""
    while node.parent is not None:
        above = node.parent
        if above.type == "annassign" and node is above.children[1]:
            return True
        if above.type == "tfpdef" and node is above.children[2]:
            return True
        if above.type == "funcdef" and node is getattr(above, "annotation", None):
            return True
        if above.type == "if_stmt" and "TYPE_CHECKING" in above.children[1].get_code():
            return True
        node = above
    return node.type == "if_stmt"


def faults_of(source: str, file: str) -> list[Fault]:
    """Return every possible mutant of a source file."""
    tree = load_grammar().parse(source)
    nodes = list(_nodes(tree))
    faults = []
    for name in OPERATORS:
        operator = _operator(name)
        count: Counter[str] = Counter()
        for node in nodes:
            for (line, column), _ in operator.mutation_positions(node):
                occurrence = count[name]
                count[name] += 1
                if not _is_for_types(node):
                    faults.append(Fault(file, line, column, name, occurrence))
    return faults


def _compiles(fault: Fault, source: str) -> bool:
    """Return True if the mutant compiles; some, such as `**` of a dictionary, do not."""
    try:
        compile(fault.applied(source), fault.file, "exec")
    except SyntaxError:
        return False
    return True


def drawn(root: Path, files: list[Path], seed: str) -> Iterator[Fault]:
    """Generate one mutant per site; sites and mutants are in random order.

    A longer sample with the same seed begins with the shorter one.
    """
    sites: dict[tuple[str, int, int], list[Fault]] = defaultdict(list)
    sources = {path.relative_to(root).as_posix(): path.read_text("utf-8") for path in files}
    for file, source in sources.items():
        for fault in faults_of(source, file):
            sites[fault.file, fault.line, fault.column].append(fault)
    chance = random.Random(seed)
    order = sorted(sites)
    chance.shuffle(order)
    for site in order:
        fault = chance.choice(sites[site])
        if _compiles(fault, sources[fault.file]):
            yield fault
