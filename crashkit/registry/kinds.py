"""The kinds of plugin: how each is called, which hook returns it, and what it must be."""

from attrs import frozen

from crashkit.protocols import Hypothesis, Identifier, Importer, Observer, Smoother, SpringLaw


@frozen
class Kind:
    """A kind of plugin.

    Arguments:
        title: as people call it.
        hook: the hook that returns its classes.
        base: the abstract class that they implement.
        label: the class attribute that holds the name.
    """

    title: str
    hook: str
    base: type
    label: str = "name"


KINDS = (
    Kind("spring law", "crashkit_spring_laws", SpringLaw),
    Kind("observer", "crashkit_observers", Observer),
    Kind("smoother", "crashkit_smoothers", Smoother),
    Kind("identifier", "crashkit_identifiers", Identifier),
    Kind("hypothesis", "crashkit_hypotheses", Hypothesis, label="physics"),
    Kind("importer", "crashkit_importers", Importer),
)
