"""Write the table of the policy, docs/reference/policy.md: `.venv/bin/python docs/policy.py`."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from jbf import Policy

PAGE = Path(__file__).resolve().parent / "reference" / "policy.md"
HEAD = """# Policy
Every number that influences a verdict, with its default and its source. `jbf.Policy` has them as
fields, and a diagnosis writes them to its JSON (`policy`). Evidence and gains are in twice the log
likelihood. To change values:

```python
import jbf

policy = jbf.Policy().with_values({"terms.max_updates": 6, "estimation.variance.chance": 0.001})
```

*(Written by `docs/policy.py`.)*
"""
ROWS = "| name | default | decides | source |\n| --- | --- | --- | --- |\n"


def page() -> str:
    """Return the text of docs/reference/policy.md."""
    policy = Policy()
    return HEAD + _table(policy, "", "The user's choice") + "".join(_sections(policy, ""))


def _sections(section: Any, before: str) -> list[str]:
    """Return the tables of all sections in a part of the policy, in order."""
    sections = []
    for f in fields(section):
        value = getattr(section, f.name)
        if is_dataclass(value):
            name = f"{before}{f.name}"
            title = (type(value).__doc__ or "").splitlines()[0].rstrip(".")
            if any(not is_dataclass(getattr(value, field.name)) for field in fields(value)):
                sections.append(_table(value, f"{name}.", title))
            sections += _sections(value, f"{name}.")
    return sections


def _table(section: Any, before: str, title: str) -> str:
    lines = [
        f"| `{before}{f.name}` | {getattr(section, f.name)} | {f.metadata['decides']} "
        f"| {f.metadata['source']} |\n"
        for f in fields(section)
        if "decides" in f.metadata
    ]
    return f"\n## {title}\n{ROWS}{''.join(lines)}"


if __name__ == "__main__":
    PAGE.write_text(page())
