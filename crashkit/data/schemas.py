"""The schemas of the core, and the pieces from which an Observer builds the schema of its instrument."""

from crashkit.data.schema import Attribute, Dimension, GroupSchema, Variable

DIMENSIONS = (
    Dimension("time", "s, strictly increasing, need not be uniform"),
    Dimension("body", "names of bodies"),
    Dimension("joint", "names of joints", least=0),
    Dimension("marker", "names of markers on a film"),
    Dimension("sensor", "names of sensors"),
    Dimension("view", "a camera", labelled=False),
    Dimension("axis", "axes of the laboratory frame, or of the body's own for sensors", values=("x", "y", "z")),
    Dimension("image_axis", "axes of an image", labelled=False, values=("u", "v")),
    Dimension("quaternion", "components of a unit quaternion", labelled=False, values=("w", "x", "y", "z")),
    Dimension("control_point", "points of known place, seen by the cameras", labelled=False),
    Dimension("parameter", "paths of parameters", labelled=False, least=0),
)

RECORDING = GroupSchema(
    "recording",
    (),
    (
        Attribute("crashkit_schema", "the version of the contract", ("recording/1",)),
        Attribute("title", "one line for people"),
    ),
)

INITIAL = GroupSchema(
    "initial",
    (
        Variable("position", ("body", "axis"), "m", "centre of mass at t = 0, the first contact"),
        Variable("velocity", ("body", "axis"), "m s-1", "at t = 0"),
        Variable("orientation", ("body", "quaternion"), "1", "at t = 0, unit quaternion (w, x, y, z)", required=False),
        Variable("angular_velocity", ("body", "axis"), "rad s-1", "at t = 0, laboratory frame", required=False),
    ),
)

MOTION = GroupSchema(
    "motion",
    (
        Variable(
            "position",
            ("time", "body", "axis"),
            "m",
            "the body's centre of mass in the laboratory frame",
            required=False,
            allow_nan=True,
        ),
        Variable("velocity", ("time", "body", "axis"), "m s-1", "its velocity", required=False, allow_nan=True),
        Variable("acceleration", ("time", "body", "axis"), "m s-2", "its acceleration", required=False, allow_nan=True),
        Variable(
            "orientation",
            ("time", "body", "quaternion"),
            "1",
            "unit quaternion (w, x, y, z), planar and spatial models only",
            required=False,
            allow_nan=True,
        ),
        Variable(
            "angular_velocity",
            ("time", "body", "axis"),
            "rad s-1",
            "planar and spatial models only",
            required=False,
            allow_nan=True,
        ),
        Variable(
            "angular_acceleration",
            ("time", "body", "axis"),
            "rad s-2",
            "planar and spatial models only",
            required=False,
            allow_nan=True,
        ),
        Variable("contact_force", ("time", "body", "axis"), "N", "net force of its joints on the body", required=False),
        Variable(
            "contact_moment",
            ("time", "body", "axis"),
            "N m",
            "net moment of its joints about its centre of mass, planar and spatial models only",
            required=False,
        ),
        Variable("deformation", ("time", "joint"), "m", "compression positive", required=False),
        Variable("deformation_rate", ("time", "joint"), "m s-1", "compression positive", required=False),
        Variable("force", ("time", "joint"), "N", "compression positive", required=False),
    ),
)

CHANNEL_FREQUENCY_CLASS = Attribute(
    "channel_frequency_class", "SAE J211 filter class of the samples; 0 for unfiltered", (0, 60, 180, 600, 1000)
)
FRAME = Attribute("frame", "whether the axes turn with the body", ("body", "laboratory"))


def body_of(channel: str) -> Variable:
    """`<channel>_body`: the body that carries each marker or sensor."""
    return Variable(f"{channel}_body", (channel,), None, "name of the body that carries it", kind="text")


def point_of(channel: str) -> Variable:
    """`<channel>_point`: the place of each marker or sensor on its body."""
    return Variable(f"{channel}_point", (channel, "axis"), "m", "its place in the body's frame, from the centre of mass")


def std_of(quantity: str, channel: str, units: str) -> Variable:
    """`<quantity>_std`: the standard deviation of each channel, if known."""
    return Variable(
        f"{quantity}_std",
        (channel,),
        units,
        "standard deviation of the samples as recorded, if known",
        required=False,
        allow_nan=True,
        positive=True,
    )
