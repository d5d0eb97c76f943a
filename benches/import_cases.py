"""Units, dates and text files with known readings, for `import_libraries.py`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime, timezone

_LBF, _KGF, _INCH = 4.4482216152605, 9.80665, 0.0254
_TURN, _DEG = 2.0 * math.pi, math.pi / 180.0
_TORQUE, _FORCE, _PRESSURE = "kg m^2 s^-2", "kg m s^-2", "kg m^-1 s^-2"

UNITS: dict[str, tuple[float, str]] = {
    # Torque
    **dict.fromkeys(("Nm", "N·m", "N.m", "N-m", "N m", "N*m"), (1.0, _TORQUE)),
    **dict.fromkeys(("Ncm", "N cm"), (1e-2, _TORQUE)),
    **dict.fromkeys(("Nmm", "N mm", "mNm"), (1e-3, _TORQUE)),
    "kNm": (1e3, _TORQUE), "J": (1.0, _TORQUE),
    **dict.fromkeys(("lbf ft", "lbf·ft", "ft-lb", "lb-ft"), (_LBF * 12 * _INCH, _TORQUE)),
    **dict.fromkeys(("in-lb", "lb-in", "lbf in", "lbf-in"), (_LBF * _INCH, _TORQUE)),
    **dict.fromkeys(("ozf in", "oz-in"), (_LBF / 16 * _INCH, _TORQUE)),
    # Force
    "N": (1.0, _FORCE), "kN": (1e3, _FORCE), "mN": (1e-3, _FORCE), "MN": (1e6, _FORCE),
    "kgf": (_KGF, _FORCE), "kp": (_KGF, _FORCE), "gf": (_KGF / 1e3, _FORCE),
    "lbf": (_LBF, _FORCE),
    # Speed and angle
    **dict.fromkeys(
        ("1/min", "U/min", "min-1", "min^-1", "min⁻¹", "/min", "rpm", "RPM", "r.p.m.", "tr/min",
         "Umdr/min", "rev/min", "giri/min"), (_TURN / 60, "rad s^-1")),
    **dict.fromkeys(("rps", "rev/s", "U/s"), (_TURN, "rad s^-1")),
    **dict.fromkeys(("rad/s", "rad s^-1"), (1.0, "rad s^-1")),
    **dict.fromkeys(("deg/s", "°/s"), (_DEG, "rad s^-1")),
    **dict.fromkeys(("°", "deg"), (_DEG, "rad")),
    **dict.fromkeys(("rev", "U", "rot", "turns"), (_TURN, "rad")),
    "gon": (math.pi / 200, "rad"), "mrad": (1e-3, "rad"),
    **dict.fromkeys(("inc", "counts", "count", "cnt", "ticks"), (1.0, "count")),
    "counts/rev": (1 / _TURN, "count rad^-1"), "inc/mm": (1e3, "count m^-1"),
    # Length and speed
    "m": (1.0, "m"), "mm": (1e-3, "m"), "µm": (1e-6, "m"), "μm": (1e-6, "m"), "um": (1e-6, "m"),
    "mil": (_INCH / 1e3, "m"), "in": (_INCH, "m"), "inch": (_INCH, "m"), '"': (_INCH, "m"),
    "ft": (12 * _INCH, "m"),
    "m/s": (1.0, "m s^-1"), "m s-1": (1.0, "m s^-1"), "mm/s": (1e-3, "m s^-1"),
    "mm·s⁻¹": (1e-3, "m s^-1"), "m/min": (1 / 60, "m s^-1"), "km/h": (1 / 3.6, "m s^-1"),
    "m/s²": (1.0, "m s^-2"), "m/s^2": (1.0, "m s^-2"), "rad/s²": (1.0, "rad s^-2"),
    # Pressure, temperature, electricity
    "bar": (1e5, _PRESSURE), "mbar": (1e2, _PRESSURE), "hPa": (1e2, _PRESSURE),
    "kPa": (1e3, _PRESSURE), "MPa": (1e6, _PRESSURE), "N/mm²": (1e6, _PRESSURE),
    "psi": (_LBF / _INCH**2, _PRESSURE),
    **dict.fromkeys(("°C", "degC", "C", "Celsius", "K"), (1.0, "K")),
    "°F": (5 / 9, "K"), "degF": (5 / 9, "K"),
    **dict.fromkeys(("A", "Arms", "A_rms", "Aeff"), (1.0, "A")), "mA": (1e-3, "A"),
    "V": (1.0, "kg m^2 s^-3 A^-1"), "mV": (1e-3, "kg m^2 s^-3 A^-1"), "mV/V": (1e-3, ""),
    "W": (1.0, "kg m^2 s^-3"), "kW": (1e3, "kg m^2 s^-3"),
    # Time
    **dict.fromkeys(("s", "sec", "Sek", "seconds"), (1.0, "s")),
    "ms": (1e-3, "s"), "msec": (1e-3, "s"), "us": (1e-6, "s"), "µs": (1e-6, "s"),
    "ns": (1e-9, "s"), "min": (60.0, "s"), "h": (3600.0, "s"),
    # Ratios, and units of rig descriptions
    **dict.fromkeys(("%", "pct", "percent", "Prozent"), (1e-2, "")),
    **dict.fromkeys(("permille", "‰"), (1e-3, "")), "-": (1.0, ""),
    "kg m²": (1.0, "kg m^2"), "kg cm^2": (1e-4, "kg m^2"), "Pa s": (1.0, "kg m^-1 s^-1"),
    "mPa s": (1e-3, "kg m^-1 s^-1"), "mPa·s": (1e-3, "kg m^-1 s^-1"), "cP": (1e-3, "kg m^-1 s^-1"),
}  # fmt: skip
"""Texts of units, with their sizes in SI units and dimensions; a revolution is an angle of 2 pi."""

TWO_MEANINGS = ("lb", "kg", "g", "t", "grad", "1/s", "s-1", "s^-1", "Hz", "oz")
"""Texts of units with two meanings: force or mass, degrees or gon, turns or radians per second."""

PINT_DEFINITIONS = """
rad = [angle] = _ = radian
newton_meter = newton * meter = Nm
newton_centimeter = 0.01 * newton * meter = Ncm
newton_millimeter = 0.001 * newton * meter = Nmm
turn = 2 * pi * rad = rev = rot = tr = U = Umdr = revolution = turns
degree = pi / 180 * rad = deg = °
gon = pi / 200 * rad
revolution_per_minute = turn / minute = rpm = RPM
revolution_per_second = turn / second = rps
encoder_count = [counts] = inc = count = counts = cnt = ticks
ampere_rms = ampere = Arms = A_rms = Aeff
kilopond = 9.80665 * newton = kp
thousandth_inch = 0.001 * inch = mil
percent_ = 0.01 = pct
""".strip().splitlines()
"""Definitions of units that the registry of pint lacks or defines with another meaning."""
PINT_REWRITES = (
    (r"^(1?/min|min-1|min\^-1|min⁻¹)$", "rpm"),
    (r"(?<=[A-Za-z])-(?=[A-Za-z])", "*"),
    (r"(?<=[A-Za-z])-(?=\d)", "**-"),
    (r'^"$', "inch"),
    (r"^r\.p\.m\.$", "rpm"),
    (r"^-$", "dimensionless"),
    (r"^C(elsius)?$", "degC"),
    (r"\b(lb|oz)(?=\*(ft|in))|(?<=(in|ft)\*)(lb|oz)\b", r"\1\4f"),
)
"""Regular expressions that replace spellings which the parser of pint does not accept."""


def _ns(*parts: int, ns: int = 0, minutes_east: int = 0) -> int:
    since = datetime(*parts, tzinfo=timezone.utc) - datetime(1970, 1, 1, tzinfo=timezone.utc)
    return (since.days * 86400 + since.seconds - 60 * minutes_east) * 10**9 + ns


_DAY, _CLOCK = (2026, 11, 24), (2026, 11, 24, 13, 5, 7)
_EARLY = (2026, 4, 3, 13, 5, 7)
DATES: dict[str, int] = {
    "2026-11-24T13:05:07": _ns(*_CLOCK),
    "2026-11-24 13:05:07": _ns(*_CLOCK),
    "2026-11-24 13:05:07.125": _ns(*_CLOCK, ns=125_000_000),
    "2026-11-24 13:05:07,125": _ns(*_CLOCK, ns=125_000_000),
    "2026-11-24T13:05:07.123456789": _ns(*_CLOCK, ns=123_456_789),
    "2026-11-24T13:05:07.1234567": _ns(*_CLOCK, ns=123_456_700),
    "2026-11-24T13:05:07Z": _ns(*_CLOCK),
    "2026-11-24 13:05:07 UTC": _ns(*_CLOCK),
    "2026-11-24T13:05:07+01:00": _ns(*_CLOCK, minutes_east=60),
    "2026-11-24T13:05:07.5-0330": _ns(*_CLOCK, ns=500_000_000, minutes_east=-210),
    "2026-11-24": _ns(*_DAY),
    "2026/11/24 13:05:07": _ns(*_CLOCK),
    "2026-04-03 13:05:07": _ns(*_EARLY),
    "2026/04/03 13:05:07": _ns(*_EARLY),
    "2026.04.03 13:05:07": _ns(*_EARLY),
    "24.11.2026 13:05:07": _ns(*_CLOCK),
    "24.11.2026 13:05:07,125": _ns(*_CLOCK, ns=125_000_000),
    "24.11.2026 13:05": _ns(*_DAY, 13, 5),
    "24.11.26 13:05:07": _ns(*_CLOCK),
    "03.04.2026 13:05:07": _ns(*_EARLY),
    "3.4.2026 13:05:07": _ns(*_EARLY),
    "03.04.2026": _ns(2026, 4, 3),
    "24/11/2026 13:05:07": _ns(*_CLOCK),
    "24-11-2026 13:05:07": _ns(*_CLOCK),
    "11/24/2026 13:05:07": _ns(*_CLOCK),
    "11/24/2026 1:05:07 PM": _ns(*_CLOCK),
    "11/24/2026 01:05:07.125 PM": _ns(*_CLOCK, ns=125_000_000),
    "11/24/2026 12:05:07 AM": _ns(*_DAY, 0, 5, 7),
    "11/24/2026 12:05:07 p.m.": _ns(*_DAY, 12, 5, 7),
    "24-Nov-2026 13:05:07": _ns(*_CLOCK),
    "Tue Nov 24 13:05:07 2026": _ns(*_CLOCK),
    "Nov 24, 2026 1:05:07 PM": _ns(*_CLOCK),
    "13:05:07": _ns(1970, 1, 1, 13, 5, 7),
    "13:05:07.125": _ns(1970, 1, 1, 13, 5, 7, ns=125_000_000),
    "13:05:07,125": _ns(1970, 1, 1, 13, 5, 7, ns=125_000_000),
    "13:05:07:125": _ns(1970, 1, 1, 13, 5, 7, ns=125_000_000),
    "1:05:07 PM": _ns(1970, 1, 1, 13, 5, 7),
    "13:05": _ns(1970, 1, 1, 13, 5),
}
"""Texts of dates and times, with their nanoseconds since 1970 or since midnight."""

NO_DATES = (
    "2026-02-30", "31.04.2026 10:00", "2026-13-01", "12:00:00 XM", "noon", "10", "1.2", "3.5 N",
    "2026-11-24 13:05:07 CET",
)  # fmt: skip
"""Texts that are not dates, or have an unknown time zone, and must be refused."""

ORDERS: tuple[tuple[list[str], str | None], ...] = (
    (["03/04/2026", "04/04/2026"], None),
    (["03/04/2026 10:00", "04/04/2026 10:00"], None),
    (["13/02/2026", "01/02/2026"], "day_first"),
    (["02/13/2026", "02/01/2026"], "month_first"),
    (["03.04.2026", "04.04.2026"], "day_first"),
)
"""Columns of dates, and whether day or month comes first; None if the column does not determine it.
"""


@dataclass(frozen=True)
class Text:
    """Text file with its expected interpretation.

    Attributes
    ----------
    header
        Number of the row with the column names, counted from 1; 0 if there is none.
    """

    data: bytes
    delimiter: str
    decimal: str
    names: tuple[str, ...]
    header: int
    encoding: str


_NAMES = ("Zeit", "Weg", "Kraft", "Drehzahl")
_UNITS = ("s", "mm", "N", "rpm")


def text(
    delimiter: str = ",",
    decimal: str = ".",
    *,
    names: tuple[str, ...] = _NAMES,
    before: tuple[str, ...] = (),
    units: str = "",
    after: str = "",
    encoding: str = "utf-8",
    thousands: str = "",
    quoted: bool = False,
    header: bool = True,
    stamps: str = "",
    words: bool = False,
    gaps: bool = False,
    columns: int = 4,
    groups: bool = False,
    blank: str = "",
) -> Text:
    """Create a text file with sixty rows of samples in the given dialect."""
    mark = delimiter + blank
    names = names[:columns]

    def shown(value: float, digits: int) -> str:
        written = f"{value:,.{digits}f}".replace(",", "\0").replace(".", decimal)
        written = written.replace("\0", thousands)
        return f'"{written}"' if quoted and delimiter in written else written

    lines = list(before)
    if groups:
        lines.append(mark.join(("", "Motor", "", "Achse")))
        names = ("t", "Motor x", "Motor v", "Achse x")
        lines.append(mark.join(("t", "x", "v", "x")) + after)
    elif header:
        lines.append(mark.join(f'"{n}"' if quoted else n for n in names) + after)
    row = len(lines) if header else 0
    if units:
        lines.append(mark.join(units.format(u) for u in _UNITS[:columns]) + after)
    for i in range(60):
        time = f"{i / 100:.2f}".replace(".", decimal)
        if stamps:
            time = stamps.format(second=i // 10, tenth=i % 10)
        if quoted and delimiter in time:
            time = f'"{time}"'
        force = "" if gaps and i % 3 else shown(-1234.5 + 37.25 * i, 2)
        cells = [time, shown(12.125 + 0.5 * i, 3), force, shown(1500.0 + i, 1)]
        if words:
            cells[3] = ("ok", "fast", "stop")[i % 3]
        lines.append(mark.join(cells[:columns]) + after)
    if not header:
        names = tuple(f"column {i}" for i in range(1, columns + 1))
    data = ("\r\n".join(lines) + "\r\n").encode(encoding)
    return Text(data, delimiter, decimal, names, row, encoding)


_TITLE = ("Messung 17 vom 24.11.2026", "Bediener: Meier", "")
_LONG = ("Logger: ACME 3000, v1.2", "Kanal;Faktor;Offset", "1;1,000;0,0", "2;0,250;0,1", "")


def texts() -> dict[str, Text]:
    """Return the text files, with their special property as key."""
    date = "24.11.2026 13:05:{second:02d},{tenth}00"
    marks = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "blank": " "}
    cases = {f"{word}, decimal point": text(mark) for word, mark in marks.items()}
    cases |= {
        f"{word}, decimal comma": text(mark, ",") for word, mark in marks.items() if mark != ","
    }
    return cases | {
        "comma, decimal comma in quotes": text(",", ",", quoted=True),
        "thousands by point": text(";", ",", thousands="."),
        "thousands by comma": text(";", ".", thousands=","),
        "thousands by apostrophe": text(";", ".", thousands="'"),
        "thousands by comma in quotes": text(",", ".", thousands=",", quoted=True),
        "quoted names": text(",", ".", quoted=True),
        "names with a comma in quotes": text(quoted=True, names=("Zeit, s", "Weg, mm", "F", "n")),
        "title lines, semicolon": text(";", ",", before=_TITLE),
        "title lines, comma": text(",", ".", before=_TITLE),
        "title lines, tab": text("\t", ",", before=_TITLE),
        "table of channels before": text(";", ",", before=_LONG),
        "row of units": text(";", ",", units="{}"),
        "row of units in brackets": text(",", ".", units="[{}]"),
        "title lines and units": text("\t", ".", before=_TITLE, units="({})"),
        "two rows of names": text(";", ",", groups=True),
        "two rows of names, comma": text(",", ".", groups=True),
        "delimiter at the end, semicolon": text(";", ",", after=";"),
        "delimiter at the end, comma": text(",", ".", after=","),
        "comments": text(",", ".", before=("# rate 100 Hz", "# a, b; c")),
        "comments, semicolon": text(";", ",", before=("% file = x.csv", "% 1,5 bar")),
        "UTF-16": text("\t", ",", encoding="utf-16"),
        "UTF-8 with mark": text(";", ",", encoding="utf-8-sig"),
        "Latin-1": text(";", ",", names=("Zeit", "Öl", "Kraft", "Prüfung"), encoding="latin-1"),
        "no names": text(",", ".", header=False),
        "no names, semicolon": text(";", ",", header=False),
        "dates": text(";", ",", stamps=date),
        "dates, decimal point": text(",", ".", stamps="2026-11-24 13:05:{second:02d}.{tenth}"),
        "times of day": text("\t", ",", stamps="13:05:{second:02d},{tenth}"),
        "words": text(";", ",", words=True),
        "empty cells": text(";", ",", gaps=True),
        "empty cells, comma": text(",", ".", gaps=True),
        "one column": text(";", ",", columns=1),
        "two columns": text(";", ",", columns=2),
        "two columns, comma": text(",", ".", columns=2),
        "blank after the comma": text(",", ".", blank=" "),
        "blank after the semicolon": text(";", ",", blank=" "),
    }  # fmt: skip
