"""``python -m puma_septic.cli``, the same as ``puma-septic``."""

from puma_septic.cli import main

raise SystemExit(main())  # pragma: no cover -- a process of its own, which the tests start
