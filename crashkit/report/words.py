"""How the report says things: verdicts, probabilities, numbers and units for people."""

import math
import re

from attrs import frozen

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@frozen
class Verdict:
    """A verdict for people: its colour on the page (a class of the style sheet), and a headline."""

    colour: str
    headline: str


VERDICTS = {
    "consistent": Verdict("good", "The model agrees with the recordings"),
    "missing_physics": Verdict("missing", "The model leaves out physics"),
    "sensor_fault": Verdict("sensor", "An instrument is at fault, not the model"),
    "unexplained": Verdict("unknown", "Something real is missing, and no known physics explains it"),
}
UNASKED = Verdict("unknown", "Something real is missing, and was not found in the time that was given")

LIKELIHOODS = ((0.99, "practically certain"), (0.9, "very likely"), (0.66, "likely"), (0.33, "about as likely as not"))
GRADES = ((0.94, "excellent"), (0.8, "good"), (0.58, "fair"))


def verdict_of(name: str, is_cut_short: bool) -> Verdict:
    """The words for a verdict, of which not everything was asked or all; one that is not known speaks for itself."""
    if is_cut_short and name == "unexplained":
        return UNASKED
    return VERDICTS.get(name, Verdict("unknown", label(name)))


def label(name: str) -> str:
    """A name of physics or of a form as a title: "rate_dependence" gives "Rate dependence"."""
    words = name.replace("_", " ").strip()
    return words[:1].upper() + words[1:]


def likelihood(probability: float) -> str:
    """How sure a probability is, in words."""
    if math.isnan(probability):
        return "not rated"
    return next((words for limit, words in LIKELIHOODS if probability >= limit), "unlikely")


def grade(rating: float) -> str:
    """The word of ISO/TS 18571 for a rating."""
    if math.isnan(rating):
        return ""
    return next((word for limit, word in GRADES if rating > limit), "poor")


def percent(probability: float) -> str:
    """A probability in percent that never claims certainty."""
    if math.isnan(probability):
        return "–"
    if probability > 0.999:
        return "> 99.9 %"
    if probability < 0.001:
        return "< 0.1 %"
    return f"{100 * probability:.1f} %" if probability < 0.1 or probability > 0.99 else f"{100 * probability:.0f} %"


def unit(units: str) -> str:
    """A CF unit as people write it: "m s-2" gives "m/s²", "1" gives ""."""
    parts = re.findall(r"([^\W\d]+|%)(-?\d+)?", units)
    upper = " ".join(_power(name, int(power or 1)) for name, power in parts if int(power or 1) > 0)
    lower = " ".join(_power(name, -int(power)) for name, power in parts if int(power or 1) < 0)
    if not lower:
        return upper
    return f"{upper or '1'}/{f'({lower})' if ' ' in lower else lower}"


def _power(name: str, power: int) -> str:
    return name if power == 1 else name + str(power).translate(SUPERSCRIPTS)


def number(value: float, digits: int = 3) -> str:
    """A number with so many significant digits; a dash for what is not finite."""
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    exponent = _exponent(value, digits)
    if -4 < exponent < 6:
        return _grouped(value, max(0, digits - 1 - exponent))
    return f"{_grouped(value / 10.0**exponent, digits - 1)}×10{str(exponent).translate(SUPERSCRIPTS)}"


def estimate(value: float, std: float) -> str:
    """A value with its standard deviation, which is given to two significant digits: "0.210 ± 0.012"."""
    if not math.isfinite(value) or std == 0.0:
        return number(value, 4)
    if not math.isfinite(std):
        return f"{number(value, 4)} (no interval)"
    place = _exponent(std, 2) - 1
    exponent = max(_exponent(value, 4), place + 1)
    if -4 < exponent < 6:
        return f"{_grouped(value, max(0, -place))} ± {_grouped(std, max(0, -place))}"
    scale, decimals = 10.0**exponent, exponent - place
    power = str(exponent).translate(SUPERSCRIPTS)
    return f"({_grouped(value / scale, decimals)} ± {_grouped(std / scale, decimals)})×10{power}"


def _exponent(value: float, digits: int) -> int:
    """The power of ten of the leading digit once rounded: 9.99 with two digits is 10."""
    return int(f"{value:.{digits - 1}e}".split("e")[1])


def _grouped(value: float, decimals: int) -> str:
    """Fixed decimals, thousands set apart by a narrow space, a true minus sign."""
    text = f"{value:,.{decimals}f}"
    return text.replace(",", "\N{NARROW NO-BREAK SPACE}").replace("-", "\N{MINUS SIGN}")
