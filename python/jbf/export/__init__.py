"""Fitted model as source code for firmware: Rust for the crate `jbf-core`, C for its C interface.

Input: a `Model`. Output: text with the constants of exactly the law and the effects of the model,
and the calls that build it. The physics stays in the core, so that steps on the target along the
motion of `record` are bit-identical to `jbf predict`. In Rust the effects are a typed set: the
target reserves memory only for those of the model.

- `numbers`: language-independent data of a model.
- `constants`: the constants, in the syntax of a language.
- `rust`, `c`: the languages, and the calls around the constants.
- `record`: the motion of a run, as an exported model receives it.

May import: `jbf.models`; nothing from estimation, diagnosis or reporting.
"""

from jbf.export.c import c
from jbf.export.record import Record, record
from jbf.export.rust import rust

__all__ = ["Record", "c", "record", "rust"]
