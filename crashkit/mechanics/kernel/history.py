# mypy: disable-error-code="no-untyped-def, no-untyped-call"
"""What a run remembers of each step, so that it can be taken again: its state, time and branches."""

from crashkit.mechanics.kernel.arrays import START
from crashkit.mechanics.kernel.line import AXES
from crashkit.mechanics.kernel.stand_ins import compiled

# ---- compiled from here ----


@compiled
def remember(bodies, joints, functions, state, t, piece, k, crossing, history, s):
    """The step that begins at START becomes entry s of the history.

    Arguments:
        t, piece: its time, and the piece of what is given.
        k: the entry of the record that it is, or NONE.
        crossing: whether branches were changed there.
    """
    end = state.shape[1] // 2
    for i in range(end):
        history[s, i] = state[START, i]
    history[s, end] = t
    history[s, end + 1] = piece
    history[s, end + 2] = k
    history[s, end + 3] = 1.0 if crossing else 0.0
    end += 4
    for joint in joints:
        history[s, end] = joint.d_max
        history[s, end + 1] = joint.loading
        end += 2
    for function in functions:
        history[s, end] = function.mode
        history[s, end + 1] = function.memory_mode
        end += 2
    if AXES == 3:
        for i in range(4 * bodies.size):
            history[s, end + i] = bodies[i // 4].frame[9 + i % 4]


@compiled
def recall(bodies, joints, functions, state, history, s):
    """Return to the start of a step; returns its time, piece, entry of the record, and whether branches were changed there."""
    size = state.shape[1] // 2
    for i in range(size):
        state[START, i] = history[s, i]
    for j in range(joints.size):
        recall_branches(joints, functions, history, s, size, j)
    if AXES == 3:
        end = size + 4 + 2 * joints.size + 2 * functions.size
        for i in range(4 * bodies.size):
            bodies[i // 4].frame[9 + i % 4] = history[s, end + i]
    return history[s, size], int(history[s, size + 1]), int(history[s, size + 2]), history[s, size + 3] > 0.0


@compiled
def recall_branches(joints, functions, history, s, size, j):
    """Give a joint the branches that it had in a step."""
    joint, end = joints[j], size + 4
    joint.d_max = history[s, end + 2 * j]
    joint.loading = int(history[s, end + 2 * j + 1])
    end += 2 * joints.size
    for f in range(joint.start, joint.stop):
        functions[f].mode = int(history[s, end + 2 * f])
        functions[f].memory_mode = int(history[s, end + 2 * f + 1])
