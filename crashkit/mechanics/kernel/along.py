# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""A law along states that are known, with its derivatives: of all the engine's work only that on memories is left."""

from crashkit.mechanics.kernel.arrays import NONE, TO_D, TO_D_MAX, TO_MEMORY, TO_RATE
from crashkit.mechanics.kernel.stand_ins import compiled, law_mode, law_partials

# ---- compiled from here ----

ITERATIONS = 20
CLOSE = 1e-10
"""Share of a memory that an iteration may still change."""
LEAST_SLOPE = 0.1
"""Of the equation of a step, which is 1 for short steps; where a memory feeds itself it may vanish."""


@compiled
def follow(code, memory_code, p, times, states, choose, modes, changes, values, slopes):
    """A law at every instant of a motion that begins without memory.

    The memory z' = r(d, ddot, d_max, z, p) goes by the trapezoidal rule, z_1 = z_0 + h/2 (r_0 + r_1), and so
    (1 - h/2 dr_1/dz) dz_1/dp = (1 + h/2 dr_0/dz) dz_0/dp + h/2 (dr_0/dp + dr_1/dp). Where time goes back, another motion
    begins, again without memory.

    Arguments:
        code, memory_code: of the law and of the rate of its memory; NONE for a law without.
        p: its parameters.
        times: (time,) s.
        states: (time, 3) deformation, its rate, and the largest deformation so far.
        choose: 1 to write the branches that the law takes into `modes` (time,), 0 to keep those.
        changes: (2, 4 + parameters) room for the memory's derivatives, zeros.
        values, slopes: (time,) and (time, 4 + parameters), written: the value and its derivatives. Those to d and to the
            parameters hold what the memory owes to the past; to d as if all deformations were shifted alike.
    """
    z, rate, by_memory, past, own = 0.0, 0.0, 0.0, changes[0], changes[1]
    for i in range(times.size):
        d, ddot, d_max = states[i, 0], states[i, 1], states[i, 2]
        if memory_code != NONE:
            half = 0.5 * (times[i] - times[max(i - 1, 0)])
            if half < 0.0:
                half, z, rate, by_memory = 0.0, 0.0, 0.0, 0.0
                changes[:] = 0.0
            for c in range(past.size):
                past[c] += half * (by_memory * past[c] + own[c])
            z, rate, by_memory = solve_memory(memory_code, d, ddot, d_max, z, z + half * rate, half, p, own)
            for c in range(past.size):
                past[c] = (past[c] + half * own[c]) / step_slope(half, by_memory)
        if choose:
            modes[i] = law_mode(code, d, ddot, d_max, z, p, 0)
        values[i] = law_partials(code, modes[i], d, ddot, d_max, z, p, 0, slopes[i])
        owed = slopes[i, TO_MEMORY]
        for c in range(past.size):
            slopes[i, c] += owed * past[c]


@compiled
def solve_memory(code, d, ddot, d_max, z, begun, half, p, own):
    """The memory z = begun + half r(z), by Newton's method; returns it, its rate and that rate's derivative to it."""
    rate, by_memory = memory_rate(code, d, ddot, d_max, z, p, own)
    for _ in range(ITERATIONS):
        missing = begun + half * rate - z
        if abs(missing) <= CLOSE * abs(z):
            break
        z += missing / step_slope(half, by_memory)
        rate, by_memory = memory_rate(code, d, ddot, d_max, z, p, own)
    return z, rate, by_memory


@compiled
def memory_rate(code, d, ddot, d_max, z, p, own):
    """Rate of a memory and its derivative to that; into `own` those to the parameters, and to d if all states are shifted."""
    mode = law_mode(code, d, ddot, d_max, z, p, 0)
    rate = law_partials(code, mode, d, ddot, d_max, z, p, 0, own)
    by_memory = own[TO_MEMORY]
    own[TO_D] += own[TO_D_MAX]
    own[TO_RATE] = own[TO_D_MAX] = own[TO_MEMORY] = 0.0
    return rate, by_memory


@compiled
def step_slope(half, by_memory):
    """The derivative of the equation of a step."""
    return max(LEAST_SLOPE, 1.0 - half * by_memory)
