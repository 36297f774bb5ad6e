"""`python -m crashkit`."""

from crashkit.cli import main

raise SystemExit(main())
