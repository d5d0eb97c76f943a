"""Fitted model in the form that a controller, a simulator or a drive reads.

Input: a `Model`, and for most targets the runs along which the loss is computed.

Source code for firmware with `jbf-core`: text with the constants of exactly the law and the effects
of the model, and the calls that build it. The physics stays in the core, so that steps on the
target along the motion of `record` are bit-identical to `jbf predict`. In Rust the effects are a
typed set: the target reserves memory only for those of the model.

- `numbers`: language-independent data of a model.
- `constants`: the constants, in the syntax of a language.
- `rust`, `c`: the languages, and the calls around the constants.
- `record`: the motion of a run, as an exported model receives it.

Targets without the core (`to`, `TARGETS`), each with a ledger of what it does not carry:

- `registry`: the targets by name, and the export to one of them.
- `target`, `ledger`: settings, files and result of an export; its losses.
- `reference`: force of a model along its runs, without weight, inertia and sensor.
- `steady`: friction against speed, and its approximation by few points.
- `joint_elements`, `joint_form`: elements of a simulated joint, and a model in terms of them.
- `equations`, `step_equations`: laws and effects, and the step, independent of a language.
- `program`, `syntax`, `c_syntax`: a model composed of them, and its text in a language.
- `compiled`, `mujoco_run`, `rumoca_run`: exported forms that run along a reference.
- `compensator`: the observed compensator as equations, for the target `c`.
- `table`, `plain_c`, `structured_text`, `fmu`, `modelica`, `mjcf`, `description`: the targets.

May import: `jbf.models`, `jbf.estimation`; nothing from diagnosis or reporting.
"""

from jbf.export.c import c
from jbf.export.compensator import Compensator
from jbf.export.ledger import Ledger, RunLoss, Term
from jbf.export.record import Record, record
from jbf.export.registry import TARGETS, to
from jbf.export.rust import rust
from jbf.export.target import Exported, Settings

__all__ = [
    "TARGETS",
    "Compensator",
    "Exported",
    "Ledger",
    "Record",
    "RunLoss",
    "Settings",
    "Term",
    "c",
    "record",
    "rust",
    "to",
]
