"""The command ``curlshot`` as ``python -m curlshot``."""

import sys

from curlshot.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
