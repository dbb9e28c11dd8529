"""Progress bars of the command."""

from __future__ import annotations

import sys
from typing import Any


class Bars:
    """Progress bars on stderr, one for each kind of work."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet
        self.bars: dict[str, Any] = {}

    def __call__(self, what: str, done: int, total: int | None) -> None:
        """Show `done` of `total` steps of some work; see `curlshot.data.progress.Progress`."""
        if self.quiet:
            return
        from tqdm import tqdm

        if what not in self.bars:
            self.close()
            self.bars[what] = tqdm(total=total, desc=what.ljust(16), file=sys.stderr, leave=True)
        bar = self.bars[what]
        if total is not None and bar.total != total:
            bar.total = total
        bar.update(done - bar.n)

    def close(self) -> None:
        """Leave the bars as they stand."""
        for bar in self.bars.values():
            bar.close()
