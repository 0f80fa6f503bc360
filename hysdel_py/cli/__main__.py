"""``python -m hysdel_py.cli``, where the command ``hysdel`` is not on the path."""

from __future__ import annotations

import sys

from hysdel_py.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
