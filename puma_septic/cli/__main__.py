"""``python -m puma_septic.cli``, the same as ``puma-septic``."""

from puma_septic.cli import main

raise SystemExit(main())
