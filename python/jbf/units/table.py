"""Table of units by their names in loggers, with exact conversion factors to SI units.

A factor is a ratio of integers times a power of pi, so that a conversion is rounded only once. For
example, milliseconds are divided by 1000, not multiplied by a rounded 0.001. Angles and counts are
separate dimensions, so that a missing factor of 2 pi per revolution is an error.
"""

from __future__ import annotations

from fractions import Fraction

BASES = ("kg", "m", "s", "A", "K", "rad", "count")
"""Base units; the dimensions of a unit are exponents of these."""

Dimensions = tuple[int, ...]
Entry = tuple[Fraction, int, Dimensions]
"""Conversion factor of a unit, as ratio and power of pi, and its dimensions."""


def dimensions(**powers: int) -> Dimensions:
    """Dimensions as exponents in the order of `BASES`."""
    return tuple(powers.get(base, 0) for base in BASES)


NONE = dimensions()
TIME, LENGTH, MASS = dimensions(s=1), dimensions(m=1), dimensions(kg=1)
ANGLE, COUNT, CURRENT = dimensions(rad=1), dimensions(count=1), dimensions(A=1)
FORCE, TORQUE = dimensions(kg=1, m=1, s=-2), dimensions(kg=1, m=2, s=-2)
PRESSURE, POWER = dimensions(kg=1, m=-1, s=-2), dimensions(kg=1, m=2, s=-3)
TEMPERATURE, RATE = dimensions(K=1), dimensions(s=-1)
SPEED, SPIN = dimensions(m=1, s=-1), dimensions(rad=1, s=-1)
VOLTAGE = dimensions(kg=1, m=2, s=-3, A=-1)

_POUND = Fraction("4.4482216152605")
_KILOGRAM_FORCE = Fraction("9.80665")
_INCH = Fraction("0.0254")

_PREFIXES = {
    "n": Fraction(1, 10**9), "u": Fraction(1, 10**6), "µ": Fraction(1, 10**6),
    "μ": Fraction(1, 10**6), "m": Fraction(1, 1000), "c": Fraction(1, 100),
    "d": Fraction(1, 10), "h": Fraction(100), "k": Fraction(1000), "M": Fraction(10**6),
}  # fmt: skip
_WITH_PREFIX: dict[str, tuple[Entry, str]] = {
    "m": ((Fraction(1), 0, LENGTH), "nuµμmcdk"),
    "s": ((Fraction(1), 0, TIME), "nuµμm"),
    "sec": ((Fraction(1), 0, TIME), "nuµm"),
    "g": ((Fraction(1, 1000), 0, MASS), "mk"),
    "N": ((Fraction(1), 0, FORCE), "uµμmcdkM"),
    "Nm": ((Fraction(1), 0, TORQUE), "uµμmckM"),
    "Pa": ((Fraction(1), 0, PRESSURE), "mhkM"),
    "bar": ((Fraction(10**5), 0, PRESSURE), "m"),
    "A": ((Fraction(1), 0, CURRENT), "uµμmk"),
    "Arms": ((Fraction(1), 0, CURRENT), "m"),
    "V": ((Fraction(1), 0, VOLTAGE), "uµμmk"),
    "W": ((Fraction(1), 0, POWER), "mkM"),
    "J": ((Fraction(1), 0, TORQUE), "mk"),
    "Hz": ((Fraction(1), 0, RATE), "kM"),
    "rad": ((Fraction(1), 0, ANGLE), "uµμm"),
}
_SINGLE: dict[str, Entry] = {
    "min": (Fraction(60), 0, TIME),
    "h": (Fraction(3600), 0, TIME),
    "in": (_INCH, 0, LENGTH),
    "ft": (12 * _INCH, 0, LENGTH),
    "mil": (_INCH / 1000, 0, LENGTH),
    "Ncm": (Fraction(1, 100), 0, TORQUE),
    "Nmm": (Fraction(1, 1000), 0, TORQUE),
    "lbf": (_POUND, 0, FORCE),
    "ozf": (_POUND / 16, 0, FORCE),
    "kgf": (_KILOGRAM_FORCE, 0, FORCE),
    "gf": (_KILOGRAM_FORCE / 1000, 0, FORCE),
    "psi": (_POUND / _INCH**2, 0, PRESSURE),
    "cP": (Fraction(1, 1000), 0, dimensions(kg=1, m=-1, s=-1)),
    "lbf ft": (_POUND * 12 * _INCH, 0, TORQUE),
    "lbf in": (_POUND * _INCH, 0, TORQUE),
    "atm": (Fraction(101325), 0, PRESSURE),
    "deg": (Fraction(1, 180), 1, ANGLE),
    "gon": (Fraction(1, 200), 1, ANGLE),
    "arcmin": (Fraction(1, 10800), 1, ANGLE),
    "arcsec": (Fraction(1, 648000), 1, ANGLE),
    "rev": (Fraction(2), 1, ANGLE),
    "rpm": (Fraction(1, 30), 1, SPIN),
    "rps": (Fraction(2), 1, SPIN),
    "kph": (Fraction(1000, 3600), 0, SPEED),
    "mps": (Fraction(1), 0, SPEED),
    "%": (Fraction(1, 100), 0, NONE),
    "‰": (Fraction(1, 1000), 0, NONE),
    "1": (Fraction(1), 0, NONE),
    "count": (Fraction(1), 0, COUNT),
    "K": (Fraction(1), 0, TEMPERATURE),
}
UNITS: dict[str, Entry] = _SINGLE | {
    prefix + name: (_PREFIXES[prefix] * entry[0] if prefix else entry[0], *entry[1:])
    for name, (entry, prefixes) in _WITH_PREFIX.items()
    for prefix in ("", *prefixes)
}
"""Conversion factor and dimensions of each unit by its case-sensitive name (mN, MN)."""

ALIASES = {
    "sek": "s", "second": "s", "seconds": "s", "sekunde": "s", "sekunden": "s", "secs": "s",
    "seconde": "s", "secondes": "s", "segundos": "s", "secondi": "s", "msec": "ms",
    "millisecond": "ms", "milliseconds": "ms", "millisekunden": "ms", "usec": "us",
    "microseconds": "us", "nanoseconds": "ns", "minute": "min", "minutes": "min",
    "minuten": "min", "std": "h", "hr": "h", "hour": "h", "hours": "h", "stunden": "h",
    "metre": "m", "meter": "m", "metres": "m", "meters": "m", "millimeter": "mm",
    "millimetre": "mm", "micron": "um", "microns": "um", "inch": "in", "inches": "in", '"': "in",
    "zoll": "in", "newton": "N", "newtons": "N", "kilonewton": "kN", "newtonmeter": "Nm",
    "lbs": "lbf", "lbsf": "lbf", "pound-force": "lbf", "kp": "kgf", "pascal": "Pa",
    "ampere": "A", "amp": "A", "amps": "A", "a_rms": "Arms", "aeff": "Arms", "apk": "A",
    "volt": "V", "watt": "W", "°": "deg", "º": "deg", "degree": "deg", "degrees": "deg",
    "grad": "gon", "radian": "rad", "radians": "rad", "turn": "rev", "turns": "rev", "u": "rev",
    "umdr": "rev", "umdrehungen": "rev", "umdrehung": "rev", "tr": "rev", "giri": "rev",
    "revs": "rev", "r": "rev", "rot": "rev", "rotation": "rev", "rotations": "rev",
    "u/min": "rpm", "1/min": "rpm", "min-1": "rpm", "min^-1": "rpm",
    "min⁻¹": "rpm", "/min": "rpm", "umin": "rpm", "r.p.m.": "rpm", "rev/s": "rps", "km/h": "kph",
    "permille": "‰", "per mille": "‰", "promille": "‰", "pct": "%", "percent": "%", "perc": "%",
    "prozent": "%", "counts": "count", "cnt": "count",
    "cnts": "count", "inc": "count", "incs": "count", "increments": "count", "ink": "count",
    "inkremente": "count", "ticks": "count", "tick": "count", "pulses": "count", "steps": "count",
    "kelvin": "K", "-": "1", "–": "1", "dimensionless": "1", "oz": "ozf",
    "ft-lb": "lbf ft", "ft lb": "lbf ft", "lb-ft": "lbf ft", "lb ft": "lbf ft", "ft-lbs": "lbf ft",
    "in-lb": "lbf in", "in lb": "lbf in", "lb-in": "lbf in", "lb in": "lbf in", "in-lbs": "lbf in",
}  # fmt: skip
"""Other names, in lower case, of entries of `UNITS`."""

CELSIUS = ("°c", "degc", "deg c", "celsius", "c", "grad c", "°celsius", "ºc", "℃")
FAHRENHEIT = ("°f", "degf", "deg f", "fahrenheit", "℉")

ASK = {
    "lb": "lbf (a force) or a mass",
    "kg": "kgf (a force) or a mass",
    "g": "gf (a force), a mass or an acceleration",
    "t": "tonnes of force or of mass",
    "grad": "deg or gon",
    "1/s": "rev/s or rad/s",
    "s-1": "rev/s or rad/s",
    "s^-1": "rev/s or rad/s",
    "Hz": "rev/s or rad/s",
    "oz": "ozf (a force) or a mass",
}
"""Unit names that are ambiguous in recordings; the user must state the meaning."""

SUFFIXES = {
    "s": "s", "ms": "ms", "us": "us", "ns": "ns", "min": "min", "h": "h", "sec": "s", "m": "m",
    "mm": "mm", "um": "um", "cm": "cm", "km": "km", "in": "in", "inch": "in", "ft": "ft",
    "rad": "rad", "mrad": "mrad", "deg": "deg", "rev": "rev", "turns": "rev", "rpm": "rpm",
    "rps": "rps", "rad_s": "rad/s", "radps": "rad/s", "deg_s": "deg/s", "degps": "deg/s",
    "m_s": "m/s", "mps": "m/s", "mm_s": "mm/s", "mmps": "mm/s", "cm_s": "cm/s", "um_s": "um/s",
    "m_min": "m/min", "mm_min": "mm/min", "in_s": "in/s", "n": "N", "kn": "kN", "lbf": "lbf",
    "kgf": "kgf", "gf": "gf", "n_m": "N m", "nm": "Nm", "mnm": "mNm", "ncm": "Ncm", "knm": "kNm",
    "nmm": "Nmm", "a": "A", "ma": "mA", "arms": "Arms", "v": "V", "mv": "mV", "w": "W",
    "kw": "kW", "hz": "Hz", "khz": "kHz", "pa": "Pa", "kpa": "kPa", "mpa": "MPa", "hpa": "hPa",
    "bar": "bar", "mbar": "mbar", "psi": "psi", "percent": "%", "pct": "%", "perc": "%",
    "prozent": "%", "permille": "‰", "promille": "‰", "rot": "rev", "rot_s": "rps", "rev_s": "rps",
    "counts": "count", "count": "count", "cnt": "count", "inc": "count", "ticks": "count",
    "c": "°C", "degc": "°C", "celsius": "°C", "k": "K", "degf": "°F",
    "m_s2": "m/s^2", "rad_s2": "rad/s^2", "kg_m2": "kg m^2", "kg": "kg", "g": "g", "lb": "lb",
    "1": "1", "pa_s": "Pa s", "n_m_a": "N m/A", "n_a": "N/A",
}  # fmt: skip
"""Units by the suffix of a column or key, in lower case, as in `speed_rpm`."""
