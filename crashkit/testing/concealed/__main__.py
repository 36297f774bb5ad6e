"""`python -m crashkit.testing.concealed SEED FOLDER`: write one case."""

import argparse

from crashkit.testing.concealed.case import PHYSICS, SIZES, make_case, write_case


def main() -> None:
    """Make a case and write it."""
    parser = argparse.ArgumentParser(
        prog="python -m crashkit.testing.concealed", description="write a case with concealed physics"
    )
    parser.add_argument("seed", type=int)
    parser.add_argument("folder")
    parser.add_argument("--physics", choices=PHYSICS, help="what is concealed; chance decides if omitted")
    parser.add_argument("--size", choices=list(SIZES), help="how visible it is; chance decides if omitted")
    parser.add_argument("--open", action="store_true", help="write the truth unsealed")
    options = parser.parse_args()
    write_case(make_case(options.seed, options.physics, options.size), options.folder, sealed=not options.open)


if __name__ == "__main__":
    main()
