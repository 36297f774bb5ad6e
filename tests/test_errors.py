"""The errors that a user can mend."""

import pytest

from crashkit.errors import CrashkitError, did_you_mean, raise_together


def test_faults_of_several_checks_are_told_together():
    made = []

    def fail(line):
        made.append(line)
        raise CrashkitError(line)

    with pytest.raises(CrashkitError, match="^first\nthird$"):
        raise_together([lambda: fail("first"), lambda: made.append("second"), lambda: fail("third")])
    assert made == ["first", "second", "third"]
    raise_together([list])


@pytest.mark.parametrize(("found", "told"), [("crush_froce", ' (did you mean "crush_force"?)'), ("banana", ""), ("", "")])
def test_a_misspelt_name_is_guessed(found, told):
    assert did_you_mean(found, ["elastic_stiffness", "crush_force", "clearance"]) == told
