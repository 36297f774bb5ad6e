"""The given model: everything but the secret, as a model file, its free parameters a little off."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from crashkit.testing.concealed.scene import Scene

OFF = 0.15
"""How far the free parameters of the given model are off, at most."""


def model_text(scene: Scene, rng: np.random.Generator | None) -> str:
    """The given model as TOML; its free parameters a little off, or with no `rng` as they are."""
    if rng is not None:
        count = len(list(free_parameters(scene)))
        scene = _in_order(tuned(scene, np.log(rng.uniform(1.0 - OFF, 1.0 + OFF, count))))
    lines = ['schema = "crashkit-model/1"', 'name = "given"', 'axes = ["x"]', ""]
    lines += ["[[body]]", f'name = "{scene.obstacle}"', "fixed = true", "position = [0.0]", ""]
    for name in scene.bodies:
        body = scene.world.bodies[name]
        lines += ["[[body]]", f'name = "{name}"', f"mass = {body.mass}", f"position = [{body.position}]"]
        lines += [f"velocity = [{scene.speeds[0]}]", ""]
    for name in scene.public:
        joint = scene.world.joints[name]
        lines += ["[[joint]]", f'name = "{name}"', f'bodies = ["{joint.front}", "{joint.back}"]', f'law = "{joint.law}"']
        lines += ["[joint.parameters]", *(f"{key} = {_rounded(value, rng)}" for key, value in joint.parameters.items()), ""]
    return "\n".join(lines)


def free_parameters(scene: Scene) -> Iterator[tuple[str, str, int | None]]:
    """Joint, name and, in a list, index of every parameter that the model file leaves free."""
    for joint in scene.public:
        for name, value in scene.world.joints[joint].parameters.items():
            if isinstance(value, list):
                yield from ((joint, name, index) for index in range(len(value)))
            else:
                yield joint, name, None


def tuned(scene: Scene, logarithms: np.ndarray) -> Scene:
    """A scene whose first free parameters are multiplied by the exponentials of these."""
    scene = scene.copy()
    for (joint, name, index), logarithm in zip(list(free_parameters(scene)), logarithms, strict=False):
        parameters, factor = scene.world.joints[joint].parameters, float(np.exp(logarithm))
        if index is None:
            parameters[name] *= factor
        else:
            parameters[name][index] *= factor
    return scene


def _in_order(scene: Scene) -> Scene:
    """The same scene with its corners sorted: near ones may have changed places, which no file allows."""
    for name in scene.public:
        parameters = scene.world.joints[name].parameters
        if "deformation" in parameters:
            parameters["deformation"] = np.sort(parameters["deformation"]).tolist()
    return scene


def _rounded(value: float | list[float], rng: np.random.Generator | None) -> Any:
    if isinstance(value, list):
        return [_rounded(one, rng) for one in value]
    return float(value if rng is None else f"{value:.6g}")
