"""One engine for every model that a diagnosis tries."""


def test_the_engine_holds_the_laws_of_all_claims_before_any_is_made(workshop):
    """Among them those of a contact, which only bodies that come nearer to each other ask for."""
    laws = {function.law.name for function in workshop.engine.numbers}
    assert {"crush_stop", "dahl", "maxwell", "coulomb", "crush_plateau + folding", "viscous_power"} <= laws
