"""The news that a film shows for a while: rescues, and what failed."""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.evaluation.metrics import Fate

NEWS_SHOTS = 45  # pictures for which news stay: nearly 2 s


class News:
    """The latest news of one episode, and whether they are good."""

    def __init__(self) -> None:
        self.good = True
        self._text, self._left = "", 0
        self._saved: frozenset[str] = frozenset()

    def tell(self, text: str, good: bool) -> None:
        """Show `text` from now on."""
        self._text, self.good, self._left = text, good, NEWS_SHOTS

    def rescues(self, now: Sequence[Fate]) -> None:
        """Tell what was rescued since the last call, by the fates `now`."""
        for fate in now:
            if fate.rescued and fate.name not in self._saved:
                self.tell(f"{fate.name} is safe" + (", but damaged" if fate.damaged else ""), good=True)
        self._saved = frozenset(f.name for f in now if f.rescued)

    def shown(self) -> str:
        """The text for the next picture; empty where the news are old."""
        self._left -= 1
        return self._text if self._left >= 0 else ""
