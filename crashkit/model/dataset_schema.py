"""The variables of a model's Dataset."""

from crashkit.data.schema import Attribute, GroupSchema, Variable

PLANE_AND_SPACE = (
    Variable("gravity", ("axis",), "m s-2", "everywhere", required=False),
    Variable(
        "body_orientation",
        ("body", "orientation_component"),
        None,
        "at t = 0: the angle (rad) in the plane, the unit quaternion (w, x, y, z) in space",
        required=False,
        allow_nan=True,
    ),
    Variable(
        "body_angular_velocity",
        ("body", "rotation_component"),
        "rad s-1",
        "at t = 0: one number in the plane, three in space",
        required=False,
        allow_nan=True,
    ),
    Variable(
        "joint_normal",
        ("joint", "axis"),
        "1",
        "of the first body's face, in its frame; where missing, the joint is a line",
        required=False,
        allow_nan=True,
    ),
)
GIVEN = (
    Variable("motion_body", ("motion_sample",), None, "the body whose motion is given", kind="text", required=False),
    Variable("motion_time", ("motion_sample",), "s", "of the sample", required=False),
    Variable("motion_position", ("motion_sample", "axis"), "m", "of the centre of mass", required=False),
    Variable(
        "motion_orientation",
        ("motion_sample", "orientation_component"),
        None,
        "as of a body",
        required=False,
        allow_nan=True,
    ),
    Variable("force_body", ("force_sample",), None, "the body on which a force is given", kind="text", required=False),
    Variable("force_time", ("force_sample",), "s", "of the sample", required=False),
    Variable("force_force", ("force_sample", "axis"), "N", "on the centre of mass", required=False),
    Variable(
        "force_moment",
        ("force_sample", "rotation_component"),
        "N m",
        "one number in the plane, three in space",
        required=False,
        allow_nan=True,
    ),
)
MODEL = GroupSchema(
    "model",
    (
        Variable("body_position", ("body", "axis"), "m", "centre of mass at t = 0"),
        Variable("body_velocity", ("body", "axis"), "m s-1", "at t = 0"),
        Variable("body_fixed", ("body",), None, "whether it is held in place", kind="flag"),
        Variable("body_carrier", ("body",), None, "the body that it moves with until t = 0; empty for none", kind="text"),
        Variable("joint_bodies", ("joint", "end"), None, "names of the two bodies", kind="text"),
        Variable("joint_points", ("joint", "end", "axis"), "m", "attachment in each body's frame", allow_nan=True),
        Variable("joint_law", ("joint",), None, "name of the spring law", kind="text"),
        Variable("factor_joint", ("factor",), None, "the joint whose law it multiplies", kind="text"),
        Variable("factor_law", ("factor",), None, "name of the factor", kind="text"),
        Variable("instrument_group", ("instrument",), None, "group of the recordings", kind="text"),
        Variable("instrument_sensor", ("instrument",), None, "sensor or marker; empty for the whole instrument", kind="text"),
        Variable("value", ("parameter",), None, "in the unit that its plugin declares"),
        Variable("lower", ("parameter",), None, "lower bound", allow_infinite=True),
        Variable("upper", ("parameter",), None, "upper bound", allow_infinite=True),
        Variable("fixed", ("parameter",), None, "whether it is held in an identification", kind="flag"),
        Variable("owner_kind", ("parameter",), None, "body, joint or instrument", kind="text"),
        Variable("owner_index", ("parameter",), None, "which one, from 0"),
        Variable("parameter_name", ("parameter",), None, "as its owner calls it", kind="text"),
        Variable("parameter_index", ("parameter",), None, "place in a list, from 0; -1 for a single number"),
        *PLANE_AND_SPACE,
        *GIVEN,
    ),
    (Attribute("crashkit_schema", "the version of the contract", ("crashkit-model/1",)), Attribute("name", "of the model")),
)
