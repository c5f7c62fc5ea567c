"""Submissions whose decisions are those of another one: a copy simulates perfectly, so it shows only beside the other.

Two episodes are alike where their decisions are the same, or where their simulations went the same way, as they do
where only decisions were added that change nothing. What a copier changes in the course of each episode is not found.
"""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.evaluation.submissions.faults import COPIED, Fault
from hazard_ms.evaluation.submissions.report import Report
from hazard_ms.evaluation.submissions.simulating import NO_HASH

SHARE = 0.5  # of episodes that may be like those of another submission before it counts as a copy [ours]


def copied(report: Report, earlier: Sequence[Report]) -> list[Fault]:
    """A fault for each of the `earlier` reports by other authors whose decisions a submission has.

    Episodes of other tracks count, too, where task, seed and scene are the same.
    """
    found = []
    for other in earlier:
        if other.submission == report.submission or (other.card and report.card and _same(other, report)):
            continue
        theirs = {(one.place, one.scene): one for one in other.seen}
        both = [(one, theirs[key]) for one in report.seen if (key := (one.place, one.scene)) in theirs]
        alike = sum(_alike(one.decisions, a.decisions) or _alike(one.course, a.course) for one, a in both)
        if both and alike > SHARE * len(both):
            name = other.card.name if other.card else other.agent
            found.append(Fault(COPIED, "decisions", f"{alike} of {len(both)} episodes are those of {name!r:.100}"))
    return found


def _same(one: Report, other: Report) -> bool:
    """Whether two submissions are by the same authors, who may submit what they submitted before."""
    assert one.card and other.card
    return set(one.card.authors) == set(other.card.authors)


def _alike(one: str, other: str) -> bool:
    return one == other != NO_HASH
