"""Entry point of `python -m jbf`."""

import sys

from jbf.cli import main

if __name__ == "__main__":
    sys.exit(main())
