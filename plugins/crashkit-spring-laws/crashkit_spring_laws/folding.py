"""Folds that form one after another as a member is crushed."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw

SKEW = ParameterSpec("skew", "1", "of a fold: above 0 it rises faster than it falls", -0.98, 0.98, default=0.0, null=0.0)
POINTEDNESS = ParameterSpec(
    "pointedness", "1", "of a fold: near 1 a triangle, below 0 blunt (p)", -50.0, 0.99, default=0.0, null=0.0
)
FOLD_LENGTH = ParameterSpec("fold_length", "m", "deformation from fold to fold", lower=1e-3)
ONSET = ParameterSpec("onset", "m", "deformation at which the first fold begins", lower=0.0, default=0.0)


def _wave(phase: float, skew: float, pointedness: float) -> float:
    """A wave between -1 and 1: a sine, or leaning, pointed or blunt."""
    if skew * skew > 1e-12:
        wave = math.atan(skew * math.sin(phase) / (1.0 - skew * math.cos(phase))) / math.asin(skew)
    else:
        wave = math.sin(phase)
    if pointedness > 1e-12:
        root = math.sqrt(pointedness)
        wave = math.asin(root * wave) / math.asin(root)
    elif pointedness < -1e-12:
        root = math.sqrt(-pointedness)
        wave = math.log(root * wave + math.sqrt(root * root * wave * wave + 1.0)) / math.log(
            root + math.sqrt(root * root + 1.0)
        )
    return wave


def _steepest(skew: float, pointedness: float) -> float:
    """A slope over the phase that no such wave exceeds, but at the tips of a triangle."""
    steepest = 1.0
    if skew * skew > 1e-12:
        steepest = skew / (1.0 - max(skew, -skew)) / math.asin(skew)
    if pointedness < -1e-12:
        root = math.sqrt(-pointedness)
        steepest = steepest * root / math.log(root + math.sqrt(root * root + 1.0))
    return steepest


class Folding(SpringLaw):
    """Folds that form one after another: A exp(-weakening t) asin(s sqrt p) / asin(sqrt p), 0 before the onset.

    With the skew k, v = w + arch (cos w - 1) and s = atan(k sin v / (1 - k cos v)) / asin k: a sine for k = 0, and near 1 a
    saw, the sum of k^n sin(n v) / n. With the pointedness p near 1 a sine becomes a triangle; below 0, where the same series
    is asinh(s sqrt(-p)) / asinh(sqrt(-p)), it is blunt; for p = 0 a fold is s. There t = max(0, d_max - onset) / fold_length
    and w = 2 pi t (1 + shortening t). Folds that get longer, g = -2 shortening > 0, have w = 2 pi ln(1 + g t) / g, and a
    height lower by 1 + g t, so that each takes up as much. It depends on the largest deformation, and is released to 0 along
    a slope that no fold exceeds, A exp(-weakening t) (K (1 + arch) dw + (weakening + g) dt) / dd_max with K = |k| /
    (1 - |k|) / asin |k|, times sqrt(-p) / asinh(sqrt(-p)) where they are blunt.
    """

    name = "folding"
    parameters = (
        ParameterSpec("amplitude", "N", "force above and below the plateau (A)", lower=0.0, null=0.0),
        FOLD_LENGTH,
        ONSET,
        SKEW,
        ParameterSpec(
            "arch", "1", "of a fold: above 0 its crests are wide, its troughs narrow", 0.0, 0.95, default=0.0, null=0.0
        ),
        ParameterSpec(
            "shortening", "1", "of the folds: by which each is shorter, below 0 longer", -0.5, 0.5, default=0.0, null=0.0
        ),
        ParameterSpec(
            "weakening", "1", "of the folds: by which each is lower, as a logarithm", 0.0, 3.0, default=0.0, null=0.0
        ),
        POINTEDNESS,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        amplitude: float,
        fold_length: float,
        onset: float,
        skew: float,
        arch: float,
        shortening: float,
        weakening: float,
        pointedness: float,
    ) -> float:
        """The force, N, compression positive."""
        turns = max(0.0, d_max - onset) / fold_length
        longer = max(0.0, -2.0 * shortening)
        if longer > 0.0:
            folds = math.log(1.0 + longer * turns) / longer
        else:
            folds = turns * (1.0 + shortening * turns)
        phase = 2.0 * math.pi * folds + arch * (math.cos(2.0 * math.pi * folds) - 1.0)
        crest = _wave(phase, skew, pointedness)
        steepest = _steepest(skew, pointedness) * (1.0 + arch) * (1.0 + 2.0 * max(0.0, shortening) * turns)
        release = (2.0 * math.pi * steepest + weakening + longer) / fold_length * (d_max - d)
        height = amplitude * math.exp(-weakening * turns) / (1.0 + longer * turns)
        return height * (max(0.0, crest - release) + min(0.0, crest + release))


class FoldingShare(SpringLaw):
    """Folds in proportion to the force: 1 + share w, with the wave w(2 pi max(0, d_max - onset) / fold_length) of `folding`.

    Where the force rises, as behind a plateau, so do the folds.
    """

    name = "folding_share"
    unit = "1"
    parameters = (
        ParameterSpec("fold_share", "1", "of the force, above and below its mean (share)", 0.0, 1.0, null=0.0),
        FOLD_LENGTH,
        ONSET,
        SKEW,
        POINTEDNESS,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        fold_share: float,
        fold_length: float,
        onset: float,
        skew: float,
        pointedness: float,
    ) -> float:
        """The factor."""
        phase = 2.0 * math.pi * max(0.0, d_max - onset) / fold_length
        return 1.0 + fold_share * _wave(phase, skew, pointedness)
