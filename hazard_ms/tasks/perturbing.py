"""Refuses perturbations that would change nothing in a task."""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.spec import Task
from hazard_ms.spec.perturbation import Perturbation
from hazard_ms.tasks import task_of


def check(perturbation: Perturbation, task: Task) -> None:
    """Refuse a perturbation of which a kind would change nothing in a `task`: it raises ValueError, naming the kind."""
    if perturbation.words and not task.rewordings:
        raise ValueError(
            f"words in perturb must be 0 for {task.name}, which has no other wording, got {perturbation.words}"
        )
    if perturbation.start and task.arrange is not None:
        raise ValueError(
            f"start in perturb must be 0 for {task.name}, which chooses the start itself, got {perturbation.start}"
        )
    if perturbation.objects:
        first = task.build(task.all_scenes[0])
        if len(first.targets) == len(first.bodies):
            raise ValueError(
                f"objects in perturb must be 0 for {task.name}, in which only targets move, got {perturbation.objects}"
            )


def check_perturbation(text: str, env_id: str, physics: str, hazards: Sequence[str], severity: str) -> None:
    """Refuse a perturbation, as text, that an environment of these keywords of gym.make cannot have.

    Raises ValueError for it.
    """
    perturbation = Perturbation.read(text)
    check(perturbation, task_of(env_id, physics, hazards or None, perturbation.severity(severity, physics)))
