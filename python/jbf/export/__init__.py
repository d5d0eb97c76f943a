"""A fitted model as source for firmware: Rust for the crate `jbf-core`, C for its C interface.

Comes in: a `Model`. Goes out: text, the constants of exactly the law and the effects of the model,
and the calls that build it. The physics stays in the core, so that a step on the target has
the bits of `jbf predict`. In Rust the effects are a typed set: the target keeps memory for those of
the model and for no others.

- `numbers`: what any language needs of a model.
- `constants`: the constants, in the words of a language.
- `rust`, `c`: the languages, and the calls round the constants.

May import: `jbf.models`; nothing of estimation, diagnosis or reports.
"""

from jbf.export.c import c
from jbf.export.rust import rust

__all__ = ["c", "rust"]
