"""``python -m hysdel_py``: the command ``hysdel``."""

from __future__ import annotations

import sys

from hysdel_py.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
