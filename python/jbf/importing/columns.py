"""Recognition of the quantity and the unit of a column from its header.

A name is split into words. Each known word indicates a quantity, and some words indicate its origin
(a motor, a set point). If the words indicate several quantities, the unit in the header selects one
(speed in rpm or in m/s). The unit takes precedence over the words.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from jbf.units.table import (
    ANGLE,
    COUNT,
    CURRENT,
    FORCE,
    LENGTH,
    NONE,
    PRESSURE,
    RATE,
    SPEED,
    SPIN,
    TEMPERATURE,
    TIME,
    TORQUE,
    VOLTAGE,
    Dimensions,
)
from jbf.units.unit import Unit, parse_unit, unit_of_name

KINDS: dict[str, tuple[Dimensions, ...]] = {
    "time": (TIME,),
    "place": (LENGTH, ANGLE, COUNT),
    "speed": (SPEED, SPIN, RATE),
    "force": (FORCE,),
    "load": (FORCE, TORQUE),
    "torque": (TORQUE, NONE),
    "current": (CURRENT,),
    "temperature": (TEMPERATURE,),
    "pressure": (PRESSURE,),
    "voltage": (VOLTAGE,),
}
"""Possible dimensions of each quantity."""

_WORDS = {
    "time": "t time zeit temps tiempo tempo timestamp zeitstempel uhrzeit datum date datetime "
    "elapsed stamp laufzeit messzeit heure horodatage durée duree timestamps sec secs seconds ms "
    "msec millis milliseconds us usec micros microseconds ns nanoseconds",
    "place": "x y s pos position weg hub displacement disp stroke travel distance strecke course "
    "déplacement deplacement posición posicion auslenkung lage spostamento corsa desplazamiento "
    "posizione wegmessung encoder enc angle winkel theta phi drehwinkel angolo angulo ángulo "
    "verfahrweg schlittenposition alpha kolbenweg q qpos",
    "speed": "v n w vel velocity geschwindigkeit vitesse velocidad velocità velocita speed "
    "drehzahl omega gleitgeschwindigkeit régime regime winkelgeschwindigkeit "
    "rotationsgeschwindigkeit umdrehungszahl geschw vit velo verfahrgeschwindigkeit qd dq qdot "
    "qvel",
    "force": "f force kraft friction reibung reibkraft reibungskraft effort fuerza forza "
    "frottement ft fr ff tangential zugkraft friktion fx tangentialkraft attrito loadcell "
    "kraftmessdose presskraft vorschubkraft ffriction fricción friccion",
    "load": "load last normal normalkraft fn fz anpresskraft charge carga normale axialkraft "
    "anpressung radialkraft carico fnormal belastung",
    "torque": "torque moment drehmoment couple m md tau coppia par reibmoment tq trq mom momento "
    "antriebsmoment",
    "current": "current strom i iq courant corriente corrente motorstrom amps iact",
    "temperature": "temperature temperatur température temp temperatura tmp öltemperatur "
    "oltemperatur",
    "pressure": "pressure druck pression presión presion pressione p",
    "voltage": "voltage spannung tension volt u",
    "index": "index idx nr no number sample samples row row_number row# # nummer zeile lfd "
    "échantillon",
    "run": "run test versuch essai lauf cycle zyklus ensayo trial messung segment ciclo prova",
    "coefficient": "cof mu µ μ reibwert reibzahl reibkoeffizient coefficient",
    "acceleration": "acc accel acceleration beschleunigung accélération aceleracion",
}


_CLOCKS = {
    "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "msec": "ms", "millis": "ms",
    "milliseconds": "ms", "us": "us", "usec": "us", "micros": "us", "microseconds": "us",
    "ns": "ns", "nanoseconds": "ns",
}  # fmt: skip
"""Names of times that are units, as in logs of an Arduino, and their symbols."""


def _words(text: str) -> frozenset[str]:
    """Set of the words of a text."""
    return frozenset(text.split())


_MOTOR = {"motor", "mot", "moteur", "antrieb", "servo"}
_SETPOINT = _words(
    "soll sollwert setpoint set ref reference target cmd command demand desired consigne "
    "sp commanded vorgabe nominal sollwerte setpt"
)
_MODELLED = _words(
    "gravity model modelled feedforward estimated estimate predicted simulated compensation"
)
"""Words for computed values, which were not measured by a sensor or a drive."""
_SECOND_MEANINGS = {"effort": "torque"}
"""Second quantity of an ambiguous word: a force in French, a torque in robot logs."""
_ACTUAL = {"ist", "istwert", "actual", "act", "measured", "meas", "mess", "réel", "reel"}
_ANGLES = _words(
    "angle winkel theta phi drehwinkel angolo angulo ángulo alpha encoder enc drehzahl omega "
    "winkelgeschwindigkeit rotationsgeschwindigkeit umdrehungszahl régime regime"
)
_BY_WORD = {word: kind for kind, words in _WORDS.items() for word in words.split()}
_SPLIT = re.compile(r"[^\w#µμ]+|_+|(?<=[a-zà-ÿ])(?=[A-ZÄÖÜ])")
_NUMBERED = re.compile(r"([a-zà-ÿ]+)(\d+)")
_GENERIC = _words(
    "joint axis achse axe eje asse j data field value actual state states msg message raw filtered "
    "filt smoothed avg mean corrected abs"
)
"""Words that name neither a quantity nor a joint."""
_SHORT = 2
"""Words with at most this number of letters are symbols, and their meaning is not certain."""

_UNIT_PATTERNS = (
    re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\[\]]*)\]\s*$"),
    re.compile(r"^(?P<name>.*?)\s*\((?P<unit>[^()]*(?:\([^()]*\))?[^()]*)\)\s*$"),
    re.compile(r"^(?P<name>.*?)\s*\{(?P<unit>[^{}]*)\}\s*$"),
    re.compile(r"^(?P<name>.*?)\s*<(?P<unit>[^<>]*)>\s*$"),
    re.compile(r"^(?P<name>.+?)\s+in\s+(?P<unit>\S.*)$"),
    re.compile(r"^(?P<name>.+?)\s*,\s*(?P<unit>\S.*)$"),
    re.compile(r"^(?P<name>[^/]+?)\s*/\s*(?P<unit>\S.*)$"),
    re.compile(r"^(?P<name>.+?)\s+(?P<unit>\S+)$"),
)
"""Patterns of a unit in a header: in brackets or after the name; of the latter, the longest
applies.
"""
_IN_BRACKETS = 4


@dataclass(frozen=True)
class Header:
    """Column header, split into name, unit and indicated quantity.

    Attributes
    ----------
    name
        Header without the unit.
    unit
        Text of the unit; empty if the header states no unit.
    kind
        Quantity that the words indicate; None if they indicate none.
    sure
        Whether a whole word, and not only a symbol, indicates the quantity.
    motor, setpoint, modelled, turning
        Whether the value belongs to the motor; is a set point and not a measurement; was computed;
        has a name that indicates a rotation.
    """

    name: str
    unit: str
    kind: str | None
    sure: bool
    motor: bool = False
    setpoint: bool = False
    modelled: bool = False
    turning: bool = False
    label: str = ""


def split_unit(text: str) -> tuple[str, str]:
    """Split a header into its name and its unit, which may be empty."""
    # Names that occur twice in a file are numbered.
    heading = re.sub(r" #\d+$", "", " ".join(text.split()))
    candidates: list[tuple[str, str]] = []
    for number, pattern in enumerate(_UNIT_PATTERNS):
        match = pattern.match(heading)
        if match is None:
            continue
        name, unit = match["name"].strip(), match["unit"].strip()
        if not name or not unit or (number > 0 and parse_unit(unit) is None):
            continue
        if unit.isdigit():
            continue  # index of an array element
        # Square brackets contain a unit, known or not; the other forms may also be words.
        if number < _IN_BRACKETS:
            return name, unit
        candidates.append((name, unit))
    if candidates:
        return max(candidates, key=lambda stem_and_unit: len(stem_and_unit[1]))
    stem_and_unit = unit_of_name(heading)
    return (heading, "") if stem_and_unit is None else (heading, stem_and_unit[1].text)


def parse_header(text: str, unit: str = "") -> Header:
    """Determine name, unit and quantity of a column from its header.

    Parameters
    ----------
    unit
        Unit that the file states outside the header, if any.
    """
    name, stated = split_unit(text)
    if stated == "1" and name == " ".join(text.split()):
        stated = ""  # the number of a joint, `q_1`
    words = [word.lower() for word in _SPLIT.split(name) if word]
    unit = unit or stated or next((_CLOCKS[word] for word in words if word in _CLOCKS), "")
    if not stated or parse_unit(stated) is None:
        lower_words = words
    else:
        # A unit at the end of a name is not one of its words.
        tail = None if name.endswith("_1") else unit_of_name(name)
        lower_words = [w.lower() for w in _SPLIT.split(name if tail is None else tail[0]) if w]
    lower_words, numbers = _unnumbered(lower_words, parse_unit(unit))
    kinds = [(word, _BY_WORD[word]) for word in lower_words if word in _BY_WORD]
    kinds += [(word, _SECOND_MEANINGS[word]) for word in lower_words if word in _SECOND_MEANINGS]
    if "cell" in lower_words or "zelle" in lower_words:
        kinds = [("loadcell", "force")]
    kinds += [
        (w, k)
        for w in lower_words
        if w not in _BY_WORD and (k := _quantity_of_last_part(w)) is not None
    ]
    return Header(
        name=name,
        unit=unit,
        kind=_choose_quantity(kinds, parse_unit(unit)),
        sure=any(len(word) > _SHORT for word, _ in kinds),
        motor=any(word in _MOTOR or word.startswith("motor") for word in words),
        setpoint=any(_is_setpoint(word) for word in words) and not _ACTUAL.intersection(words),
        modelled=any(word in _MODELLED for word in words) and not _ACTUAL.intersection(words),
        turning=any(word in _ANGLES for word in lower_words),
        label="_".join([w for w in lower_words if _is_label(w)] + numbers),
    )


def _unnumbered(words: list[str], unit: Unit | None) -> tuple[list[str], list[str]]:
    """Split numbers off the ends of quantity words such as `q1`; return words and numbers."""
    stems, numbers = [], []
    for word in words:
        match = _NUMBERED.fullmatch(word)
        is_quantity = match is not None and (match[1] in _BY_WORD or match[1] in _GENERIC)
        if is_quantity and match is not None:
            kinds = {_BY_WORD.get(match[1], ""), _SECOND_MEANINGS.get(match[1], "")} & KINDS.keys()
            fits = unit is None or any(unit.dimensions in KINDS[kind] for kind in kinds)
            if fits or not kinds:
                stems.append(match[1])
                numbers.append(match[2])
                continue
        stems.append(word)
    return stems, numbers


def _is_setpoint(word: str) -> bool:
    """Whether a word names a set point, alone or in a compound (Sollgeschwindigkeit)."""
    return word in _SETPOINT or "soll" in word


def _is_label(word: str) -> bool:
    """Whether a word indicates no quantity and may be a label, such as that of a joint."""
    has_meaning = word in _BY_WORD or word in _MOTOR or _is_setpoint(word) or word in _ACTUAL
    return not has_meaning and word not in _GENERIC and _quantity_of_last_part(word) is None


def _quantity_of_last_part(word: str) -> str | None:
    """Quantity of a compound word by its known last part (Spindeldrehzahl, Hydraulikdruck)."""
    for length in range(len(word) - 1, 3, -1):
        kind = _BY_WORD.get(word[-length:])
        if kind is not None and length >= 5:
            return kind
    return None


def _choose_quantity(kinds: list[tuple[str, str]], unit: Unit | None) -> str | None:
    """Choose one quantity among those that several words of a header indicate.

    A quantity that the unit fits comes first, then long words before short ones. A load takes
    precedence over the force that its name contains.
    """
    if not kinds:
        return None
    ordered = [kind for _, kind in sorted(kinds, key=lambda k: -min(len(k[0]), 4))]
    if "run" in ordered and unit is None and len(ordered) == 1:
        return "run"
    if unit is not None:
        fitting = [k for k in ordered if k in KINDS and unit.dimensions in KINDS[k]]
        if fitting:
            return "load" if "load" in fitting and "friction" not in dict(kinds) else fitting[0]
    if "coefficient" in ordered:
        return "coefficient"
    measured = [k for k in ordered if k in KINDS] or ordered
    if "load" in measured and "force" in measured:
        strong = [word for word, kind in kinds if kind == "force" and word not in ("f", "force")]
        return "force" if any(w.startswith(("fric", "reib", "frott")) for w in strong) else "load"
    return measured[0]
