"""Random equipment of a vehicle: film, accelerometers, a load cell; some of it missing."""

from collections.abc import Mapping, Sequence

import numpy as np

from crashkit.testing.concealed.instruments import Instrument, Sensor


def draw_instruments(
    rng: np.random.Generator,
    film_rates: Sequence[float],
    reading: tuple[float, float],
    obstacle: str,
    masses: Mapping[str, float],
    deceleration: float,
    wall: bool,
    complete: bool,
) -> dict[str, Instrument]:
    """Instruments by the name of their group.

    Arguments:
        rng: chance.
        film_rates: Hz, to choose from.
        reading: m, least and largest error of a reading of the film.
        obstacle: the body that a load cell is on.
        masses: kg, of the moving bodies.
        deceleration: m s-2, typical.
        wall: with a load cell for certain.
        complete: film and accelerometers on every body.
    """
    film = Instrument("film", float(rng.choice(film_rates)))
    rate = float(rng.choice([5000.0, 10000.0, 20000.0], p=[0.2, 0.65, 0.15]))
    cfc = int(rng.choice([0, 60, 180, 600, 1000], p=[0.45, 0.1, 0.25, 0.15, 0.05]))
    if rate == 5000.0 and cfc == 1000:
        cfc = 0  # its corner lies beyond what that rate can hold
    accelerometer = Instrument("accelerometer", rate, cfc=cfc)
    film_noise, shaking = rng.uniform(*reading), deceleration * np.exp(rng.uniform(np.log(0.01), np.log(0.08)))
    for body in masses:
        film.sensors[f"{body}_dot"] = _marker(rng, body, film_noise)
        accelerometer.sensors[f"{body}_a"] = Sensor(body, shaking)
        if rng.random() < 0.15:
            accelerometer.sensors[f"{body}_b"] = Sensor(body, shaking)
    instruments = {"film": film, "accelerometer": accelerometer}
    if wall or rng.random() < 0.45:
        plate = Sensor(obstacle, deceleration * sum(masses.values()) * rng.uniform(0.01, 0.04))
        instruments["load_cell"] = Instrument("load_cell", rate, {"plate": plate}, cfc)
    if not complete:
        _lose(rng, instruments, list(masses))
    for instrument in instruments.values():
        instrument.std_given = bool(rng.random() < 0.8)
    return instruments


def _marker(rng: np.random.Generator, body: str, noise: float) -> Sensor:
    marker = Sensor(body, noise, hidden=rng.uniform(0.0, 0.05))
    if rng.random() < 0.2:
        start = rng.uniform(0.005, 0.08)
        marker.block = (start, start + rng.uniform(0.003, 0.015))
    return marker


def _lose(rng: np.random.Generator, instruments: dict[str, Instrument], bodies: list[str]) -> None:
    """Film only, accelerometers only, or a body that one of them or neither sees; mostly nothing is lost."""
    lost = str(rng.choice(["nothing", "film", "accelerometer", "one", "body"], p=[0.64, 0.08, 0.08, 0.12, 0.08]))
    if lost in instruments:
        del instruments[lost]
    if len(bodies) > 1 and lost in ("one", "body"):
        body = str(rng.choice(bodies))
        groups = ["film", "accelerometer"] if lost == "body" else [str(rng.choice(["film", "accelerometer"]))]
        for group in groups:
            sensors = instruments[group].sensors
            for name in [name for name, sensor in sensors.items() if sensor.body == body]:
                del sensors[name]
