"""Film against accelerometers: does the displacement that one saw follow from the acceleration that the other felt?"""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.linalg import solve_triangular
from scipy.stats import chi2

from crashkit.errors import CrashkitError, did_you_mean
from crashkit.misfit.double_integral import Route, Watcher
from crashkit.protocols import Observer

MODES = 12
"""Cosines of a record in which the instruments are compared: what is faster is the noise of single frames."""
FEWEST_FRAMES = 8
SIGNIFICANT = 1e-3
"""The probability of as large a difference by chance, below which instruments contradict each other."""
SEEN = 3.0
"""Standard deviations from which an error is seen."""
STEP = 1e-3
"""Of a velocity, m s-1, or of a sensitivity, for a derivative."""


def cross_check(
    recording: xr.DataTree,
    observers: Mapping[str, type[Observer]],
    film: str = "film",
    accelerometer: str = "accelerometer",
    known_velocity: bool = False,
) -> xr.Dataset:
    """Displacement from film against displacement from accelerometers, for the same points.

    The accelerations are integrated twice, the film's observer says where its markers would then have been seen, and that is
    compared with where they were seen. Where each marker starts is free, so that displacements are compared, and so is the
    velocity of each body at t = 0, unless it is known. The noise of each accelerometer, as its first cosines, takes the same
    way, and gives the covariance of what it predicts.

    Arguments:
        recording: of one test.
        observers: the installed observers by name.
        film, accelerometer: names of groups; whatever follows bodies, and whatever gives their accelerations, will do.
        known_velocity: hold to the velocity of the recording's `initial` group.

    Returns:
        Dataset with the dims of the film: displacements `film` and `accelerometer` with `film_std` and `accelerometer_std`,
        and `difference` with `difference_std`; by `body`: `chi_square`, `degrees_of_freedom`, `probability` (of a difference
        as large by chance), `consistent`, `detectable_gain` (the relative error of the accelerometers' sensitivity that would
        have been seen) and `sentence`; and the attribute `not_compared`, a sentence on bodies that only one of them watches,
        empty where there are none.

    Raises CrashkitError where the accelerometers tell of no body that the film shows, or are no other kind of instrument.

    Figure 6 of Mizzi & Jezequel, JSV 159 (1992) 57.
    """
    seeing, feeling = (_watcher(recording, name, observers) for name in (film, accelerometer))
    if type(seeing.observer) is type(feeling.observer):
        raise CrashkitError(f"expected film and accelerometers, found {film} and {accelerometer}, both of one kind")
    felt = _felt(feeling, accelerometer)
    bodies = [body for body in dict.fromkeys(seeing.bodies) if body in felt]
    if not bodies:
        raise CrashkitError(f"expected a body that both {film} and {accelerometer} watch, found {seeing.bodies} and {felt}")
    initial = recording.children["initial"].to_dataset(inherit=False) if "initial" in recording.children else None
    checks = [_check(body, seeing.on(body), feeling.on(body), initial, known_velocity) for body in bodies]
    displacements = xr.concat([seen for seen, _ in checks], dim=seeing.observer.channel)
    check = displacements.merge(xr.concat([verdict for _, verdict in checks], dim="body"))
    return check.assign_attrs(not_compared=_not_compared({film: seeing.bodies, accelerometer: feeling.bodies}, bodies))


def _felt(feeling: Watcher, name: str) -> list[str]:
    """The bodies whose accelerations an instrument gives."""
    motion = feeling.observer.reconstruct(feeling.group)
    if "acceleration" not in motion:
        raise CrashkitError(f"{name}: expected an instrument that gives accelerations, found a {feeling.observer.name}")
    return list(motion["body"].values.tolist())


def _not_compared(watched: Mapping[str, Sequence[str]], compared: Sequence[str]) -> str:
    """What each instrument watches beside the bodies that are compared."""
    others = [(name, ", ".join(dict.fromkeys(body for body in own if body not in compared))) for name, own in watched.items()]
    told = "; ".join(f"{bodies} of {name}" for name, bodies in others if bodies)
    return f"not compared: {told}" if told else ""


def _watcher(recording: xr.DataTree, name: str, observers: Mapping[str, type[Observer]]) -> Watcher:
    if name not in recording.children:
        close = did_you_mean(name, recording.children)
        raise CrashkitError(f"expected a group {name}, found {', '.join(recording.children)}{close}")
    group = recording.children[name].to_dataset(inherit=False)
    observer = str(group.attrs.get("observer", "none"))
    if observer not in observers:
        raise CrashkitError(f"{name}: expected an installed observer ({', '.join(sorted(observers))}), found {observer}")
    return Watcher(observers[observer](), group)


def _check(
    body: str, film: Watcher, accelerometer: Watcher, initial: xr.Dataset | None, known_velocity: bool
) -> tuple[xr.Dataset, xr.Dataset]:
    """The displacements of one body's markers, and the verdict on it."""
    knows = initial is not None and body in initial["body"].values
    if known_velocity and not knows:
        raise CrashkitError(f"expected the velocity of {body} in the group initial, found none")
    route = Route(film, accelerometer, initial if knows else None)
    predicted = route.shown()
    speeds = [] if known_velocity else [(route.shown(faster=step) - predicted) / STEP for step in STEP * np.eye(route.axes)]
    gain = (route.shown(accelerometer.samples * (1.0 + STEP)) - predicted) / STEP
    frames = _Frames.of(film, predicted)
    fit = _Fit(frames, np.stack(speeds, axis=-1) if speeds else np.empty((*predicted.shape, 0)), route.noise())
    return _displacements(film, frames, fit, predicted), _verdict(body, fit, gain)


@frozen(eq=False)
class _Frames:
    """The frames of a film that are compared.

    Attributes:
        difference: recorded - predicted, (time, column), NaN where one of them is unknown.
        std: of a reading, (column,).
        bases: for each column the orthonormal cosines of the frames that were seen, without the constant, (frame, cosine).
    """

    difference: np.ndarray
    std: np.ndarray
    bases: tuple[np.ndarray, ...]

    @classmethod
    def of(cls, film: Watcher, predicted: np.ndarray) -> "_Frames":
        difference = film.samples - predicted
        times = film.group["time"].values
        return cls(difference, film.noise, tuple(_cosines(times[np.isfinite(column)]) for column in difference.T))

    def projected(self, columns: np.ndarray) -> np.ndarray:
        """(time, column, any) in the cosines of each column over its standard deviation, (cosine of a column, any)."""
        parts = [
            basis.T @ columns[np.isfinite(seen), column] / std
            for column, (basis, seen, std) in enumerate(zip(self.bases, self.difference.T, self.std, strict=True))
        ]
        return np.concatenate(parts)

    def mean(self, columns: np.ndarray) -> np.ndarray:
        """Of (time, column, any) over the frames that were seen."""
        seen = np.isfinite(self.difference)[..., None]
        return np.asarray(np.sum(np.where(seen, columns, 0.0), axis=0) / seen.sum(axis=0))


def _cosines(times: np.ndarray) -> np.ndarray:
    if len(times) < FEWEST_FRAMES:
        raise CrashkitError(f"expected at least {FEWEST_FRAMES} frames that the accelerometers cover, found {len(times)}")
    share = (times - times[0]) / (times[-1] - times[0])
    orders = np.arange(1 + min(MODES, len(times) // 3))
    return np.linalg.qr(np.cos(np.pi * np.outer(share, orders)))[0][:, 1:]


class _Fit:
    """The velocities that suit both instruments best, and what is left.

    Arguments:
        frames: of the film.
        speeds: what each free velocity changes, (time, column, speed).
        noise: what the noise of the accelerometers changes, (time, column, cosine).
    """

    def __init__(self, frames: _Frames, speeds: np.ndarray, noise: np.ndarray) -> None:
        self._frames, self._speeds = frames, speeds
        cosines = frames.projected(noise)
        self._root = np.linalg.cholesky(np.eye(len(cosines)) + cosines @ cosines.T)
        self._design = self._white(speeds)
        self.offset = self._fitted(frames.difference[..., None])[..., 0]
        self.std = np.sqrt(np.sum((noise - self._fitted(noise)) ** 2, axis=-1))

    @property
    def chi_square(self) -> float:
        """Of the difference in the cosines."""
        return float(np.sum(self._unexplained(self._frames.difference[..., None]) ** 2))

    @property
    def degrees_of_freedom(self) -> int:
        return len(self._design) - int(np.linalg.matrix_rank(self._design)) if self._design.size else len(self._design)

    def detectable(self, change: np.ndarray) -> float:
        """How much of a change (time, column) would have been seen."""
        information = np.sum(self._unexplained(change[..., None]) ** 2)
        return float(SEEN / np.sqrt(information)) if information > 0.0 else np.inf

    def _white(self, columns: np.ndarray) -> np.ndarray:
        return np.asarray(solve_triangular(self._root, self._frames.projected(columns), lower=True))

    def _velocities(self, columns: np.ndarray) -> np.ndarray:
        return np.linalg.lstsq(self._design, self._white(columns), rcond=1e-10)[0]

    def _unexplained(self, columns: np.ndarray) -> np.ndarray:
        return self._white(columns) - self._design @ self._velocities(columns)

    def _fitted(self, columns: np.ndarray) -> np.ndarray:
        """The part of (time, column, any) that free starts and velocities explain."""
        moved = self._speeds @ self._velocities(columns)
        return moved + self._frames.mean(columns - moved)


def _displacements(film: Watcher, frames: _Frames, fit: _Fit, predicted: np.ndarray) -> xr.Dataset:
    """Of the markers, from where the accelerometers say that they were in the first frame."""
    quantity = film.group[film.observer.quantity]
    followed = predicted + fit.offset
    start = np.take_along_axis(followed, np.isfinite(frames.difference).argmax(axis=0)[None], axis=0)
    columns = {
        "film": film.samples - start,
        "accelerometer": followed - start,
        "accelerometer_std": fit.std,
        "difference": film.samples - followed,
        "difference_std": np.hypot(fit.std, frames.std),
    }
    units = {"units": quantity.attrs.get("units", "")}
    variables = {name: (quantity.dims, values.reshape(quantity.shape), units) for name, values in columns.items()}
    variables["film_std"] = (quantity.dims[1:], frames.std.reshape(quantity.shape[1:]), units)
    return xr.Dataset(variables, {dim: film.group[dim] for dim in quantity.dims if dim in film.group})


def _verdict(body: str, fit: _Fit, gain: np.ndarray) -> xr.Dataset:
    probability = float(chi2.sf(fit.chi_square, fit.degrees_of_freedom))
    consistent, detectable = probability >= SIGNIFICANT, fit.detectable(gain)
    verdict = "agree" if consistent else "contradict each other"
    sentence = (
        f"film and accelerometers of {body} {verdict} (chi-square {fit.chi_square:.3g} on {fit.degrees_of_freedom} degrees of "
        f"freedom); an error of {100.0 * detectable:.2g} % of the accelerometers' sensitivity would have been seen"
    )
    numbers = {
        "chi_square": fit.chi_square,
        "degrees_of_freedom": fit.degrees_of_freedom,
        "probability": probability,
        "consistent": consistent,
        "detectable_gain": detectable,
        "sentence": sentence,
    }
    return xr.Dataset({name: ("body", [value]) for name, value in numbers.items()}, {"body": [body]})
