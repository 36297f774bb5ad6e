"""Parameters that several laws declare alike."""

from crashkit.protocols import ParameterSpec

NEVER = 1e12
"""N; no joint bears more."""

UNLOADING_STIFFNESS = ParameterSpec(
    "unloading_stiffness",
    "N m-1",
    "slope of unloading and reloading; omitted (0): unloads along the loading curve",
    lower=1.0,
    default=0.0,
    null=0.0,
)
RATE_COEFFICIENT = ParameterSpec(
    "rate_coefficient", "s m-1", "relative rise of the force with deformation rate (a)", lower=0.0, default=0.0, null=0.0
)
CLEARANCE = ParameterSpec("clearance", "m", "gap that closes before the joint pushes", lower=0.0, default=0.0, null=0.0)
TOE = ParameterSpec(
    "toe", "m", "way over which the joint engages softly, after the clearance", lower=0.0, default=0.0, null=0.0
)
TENSION = ParameterSpec(
    "tension",
    "1",
    "1 where the joint also pulls, 0 where it only pushes",
    lower=0.0,
    upper=1.0,
    default=0.0,
    free=False,
    null=0.0,
)
TENSION_FORCE = ParameterSpec(
    "tension_force", "N", "the most that the joint bears where it pulls", lower=0.0, default=NEVER, null=NEVER
)
ENGAGEMENT = ParameterSpec(
    "engagement",
    "m",
    "deformation over which the force sets in, so that it is continuous",
    lower=1e-6,
    default=1e-3,
    free=False,
)
