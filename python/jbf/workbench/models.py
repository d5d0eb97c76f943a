"""Tree of the models of a session, and the model that is displayed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from jbf.errors import InputError
from jbf.workbench.banner import banner_of

MOST_COMPARED = 3
"""Maximum number of models that are drawn for comparison; each has a colour on the page."""
LARGE = ("model", "report")
"""Keys of large contents, which the page requests separately."""


@dataclass
class Models:
    """Tree of models, each derived from a parent model.

    Attributes
    ----------
    nodes
        Data of each model by number; `parent` is the number of the model it was derived from.
    current
        Number of the model that the plots show.
    compared
        Numbers of further models that are drawn for comparison.
    undone
        Numbers of the models to which `redo` returns, the next one last.
    """

    nodes: dict[int, dict[str, Any]] = field(default_factory=dict)
    current: int | None = None
    compared: list[int] = field(default_factory=list)
    undone: list[int] = field(default_factory=list)

    def add(self, parent: int | None, words: str, content: Mapping[str, Any]) -> int:
        """Add a model to the tree, make it the current one, and return its number."""
        number = max(self.nodes, default=0) + 1
        self.nodes[number] = {"id": number, "parent": parent, "words": words, **content}
        self.choose(number)
        return number

    def node(self, number: int | None = None) -> dict[str, Any]:
        """Return the data of the model with this number, by default of the current model.

        Raises
        ------
        InputError
            There is no such model.
        """
        at = self.current if number is None else number
        if at is None or at not in self.nodes:
            raise InputError(problem="this model does not exist", remedy="fit or select one")
        return self.nodes[at]

    def choose(self, number: int | None) -> None:
        """Make a model the current one; None displays only the records."""
        self.current = None if number is None else int(self.node(number)["id"])
        self.undone.clear()
        self.compared = [other for other in self.compared if other != self.current]

    def compare_with(self, number: int, on: bool) -> None:
        """Draw a further model for comparison, or no longer.

        Raises
        ------
        InputError
            There is no such model, or `MOST_COMPARED` models are drawn already.
        """
        self.node(number)
        others = [other for other in self.compared if other != number]
        if on and len(others) >= MOST_COMPARED:
            problem = f"{MOST_COMPARED} models are compared already"
            raise InputError(problem=problem, remedy="deselect one of them")
        self.compared = [*others, number] if on else others

    def label(self, number: int, name: str, note: str) -> None:
        """Set the name and the note of a model; empty texts remove them."""
        self.node(number).update(name=name.strip(), note=note.strip())

    def undo(self) -> int | None:
        """Make the parent of the current model the current one; the model stays in the tree."""
        undone, parent = [*self.undone, int(self.node()["id"])], self.node()["parent"]
        self.choose(parent)
        self.undone = undone
        return self.current

    def redo(self) -> int:
        """Make the model that was undone last the current one again.

        Raises
        ------
        InputError
            No model was undone.
        """
        if not self.undone:
            raise InputError(problem="no model was undone", remedy="select one of the list")
        *rest, number = self.undone
        self.choose(number)
        self.undone = rest
        return number

    def ledger(self) -> list[dict[str, Any]]:
        """Errors of the models from the first one to the current one."""
        line, at = [], self.current
        while at is not None:
            node = self.nodes[at]
            line.append(node)
            at = node["parent"]
        keys = ("id", "words", "effects", "changes", "rms", "held_out_rms", "noise_rms")
        return [{key: node.get(key) for key in keys} for node in reversed(line)]

    def to_dict(self, used: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Data of the model tree for the page, without the contents named in `LARGE`.

        `used` are the runs and trims that a fit would use now.
        """
        return {
            "current": self.current,
            "compared": self.compared,
            "can_redo": bool(self.undone),
            "ledger": self.ledger(),
            "nodes": [
                {key: value for key, value in node.items() if key not in LARGE}
                | {"has_report": "report" in node, "banner": banner_of(node, used)}
                for node in self.nodes.values()
            ],
        }
