"""Settings of the observed compensator and its loop; `jbf control tune` writes them as TOML."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

import tomlkit

from jbf.errors import InputError
from jbf.records.run import PathLike
from jbf.records.toml_file import number, read_toml, refuse_unknown
from jbf.text_files import write_text

_HEADER = """\
jbf control settings, in SI units; `jbf control tune MODEL` computes them from a fitted model."""

_NOTES = {
    "bandwidth_rad_s": "poles of the observer",
    "learning_1_s": "rate at which a persistent correction is attributed to friction",
    "level_limit_v": "limit of the correction of the friction level",
    "rest_limit_v": "limit of all other corrections",
    "slow_rad_s": "speed below which the shaft counts as slow",
    "loop_rad_s": "natural frequency of the stiffened position loop",
    "breakaway": "share of the level that is applied at slow speed",
    "moving_v": "voltage that moves the shaft with certainty",
    "patience_s": (
        "time after which a constant counter counts as frozen, or a saturated loop falls back"
    ),
}


@dataclass(frozen=True)
class Settings:
    """Settings of the observed compensator and of the loop guard.

    Attributes
    ----------
    bandwidth_rad_s, learning_1_s
        Bandwidth of the friction observer, and rate at which the friction level is learned.
    level_limit_v, rest_limit_v
        Limits of the correction of the friction level, and of all other corrections, V.
    slow_rad_s
        Speed below which the shaft counts as slow.
    loop_rad_s
        Natural frequency of the stiffened position loop.
    breakaway
        Share of the friction level that is applied at slow speed.
    moving_v
        Voltage that moves the shaft with certainty.
    patience_s
        Time after which a constant counter counts as frozen, or a saturated loop falls back.
    """

    bandwidth_rad_s: float
    learning_1_s: float
    level_limit_v: float
    rest_limit_v: float
    slow_rad_s: float
    loop_rad_s: float
    breakaway: float
    moving_v: float
    patience_s: float

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not 0.0 <= number(value, name) < float("inf"):
                raise InputError(
                    key=name,
                    problem=f"{value} is negative or not finite",
                    remedy="correct the value",
                )

    def to_toml(self) -> str:
        """Text of the settings file that `save` writes."""
        document = tomlkit.document()
        document.add(tomlkit.comment(_HEADER))
        for name, value in asdict(self).items():
            item = tomlkit.item(float(f"{value:.6g}"))
            document[name] = item.comment(_NOTES[name])
        return tomlkit.dumps(document)

    def save(self, path: PathLike) -> None:
        """Write the settings as TOML."""
        write_text(path, self.to_toml())

    @classmethod
    def load(cls, path: PathLike) -> Settings:
        """Read settings from a file that `save` wrote.

        Raises
        ------
        InputError
            Names the file, the key and the correction.
        """
        content = read_toml(path)
        names = [f.name for f in fields(cls)]
        try:
            refuse_unknown(content, names)
            for name in names:
                if name not in content:
                    raise InputError(
                        key=name, problem="is missing", remedy="add it, or run the tuning again"
                    )
            return cls(**{name: number(content[name], name) for name in names})
        except InputError as error:
            raise error.within(file=path) from None
