"""Our tasks as a benchmark of vla-eval (allenai/vla-evaluation-harness), for any of its model servers.

Copy this file and hazard_ms/lerobot/hazard_client.py into a folder of vla-eval's side, and start a server on ours:

    python -m hazard_ms.lerobot.server
    PYTHONPATH=FOLDER vla-eval run --config hazard.yaml

with this in hazard.yaml:

    server: {url: "ws://localhost:8000"}
    benchmarks:
      - benchmark: "hazard_vla_eval:HazardBenchmark"
        episodes_per_task: 25
        params: {tasks: [HazardFire-v1, HazardFlood-v1], split: test, every: 3, seed: 0}

Episode k of a task has the seed `seed` + k, whichever shard plays it. Where the world goes on while a model thinks
(mode `live`), vla-eval asks for an action that holds the robot still; this benchmark has none, and vla-eval says so.
"""

from __future__ import annotations

from typing import Any

import hazard_client
import numpy as np
from vla_eval.benchmarks.base import StepBenchmark, StepResult
from vla_eval.specs import IMAGE_RGB, LANGUAGE, DimSpec

CAMERA = "head"


class HazardBenchmark(StepBenchmark):
    """Rescues by a policy that drives the robot. Its score `value` is the share of all value that was rescued."""

    render_backends = frozenset({"gpu", "cpu"})  # the server draws, with what it has
    _ALL_RECORD_FIELDS = frozenset({"reward", "done", "success", "value"})

    def __init__(
        self,
        tasks: list[str] | None = None,
        seed: int = 0,
        server: str = hazard_client.SERVER,
        split: str = "test",
        every: int = 1,
        side: int = 256,
        robot: str = "fetch",
        keywords: dict[str, Any] | None = None,
    ) -> None:
        """Connect to the server, which makes the first task's environment.

        Args:
            tasks: Names of tasks; None: HazardFire-v1.
            seed: That of the first episode of each task.
            server: HOST:PORT of a server of ours.
            split: Which scenes the seeds choose from.
            every: Frames of a step, a thirtieth of a second each: as in the demonstrations that a model learned from.
            side: Width and height of pictures [pixels].
            robot: The robot: fetch or g1.
            keywords: Others of HazardRobot-v1.
        """
        super().__init__()
        self._tasks, self._seed = tasks or ["HazardFire-v1"], seed
        self._given = {"server": server, "split": split, "every": every, "side": side, "robot_uids": robot}
        self._given |= keywords or {}
        self._name = self._tasks[0]
        self._made = self._env()

    @classmethod
    def configure_render(cls, mode: str) -> dict[str, str]:
        return {}

    def get_tasks(self) -> list[dict[str, Any]]:
        return [{"name": name} for name in self._tasks]

    def get_metadata(self) -> dict[str, Any]:
        return {"max_steps": None}  # each task ends its episodes itself, after as many steps as it has

    def get_metric_keys(self) -> dict[str, str]:
        return {"success": "mean", "value": "mean"}

    def get_action_spec(self) -> dict[str, DimSpec]:
        form = f"hazard_ms_{self._given['robot_uids']}"
        told = "as in demonstrations of hazard_ms: most numbers are joint positions, those of the base are speeds"
        return {"joints": DimSpec("joints", self._made.action_space.shape[0], form, description=told)}

    def get_observation_spec(self) -> dict[str, DimSpec]:
        size = self._made.observation_space["agent_pos"].shape[0]
        told = "joints, their velocities, base x, y, heading, hand x, y, z, and whether it holds something"
        state = DimSpec("state", size, f"hazard_ms_{self._given['robot_uids']}", description=told)
        return {CAMERA: IMAGE_RGB, "state": state, "language": LANGUAGE}

    def reset(self, task: dict[str, Any]) -> Any:
        seed = self._seed + task["episode_idx"]
        if task["name"] != self._name:
            self._made.close()
            self._name = task["name"]
            self._made = self._env()
        try:
            seen, _ = self._made.reset(seed=seed)
        except ConnectionError:  # it broke off in the last episode
            self._made = self._env()
            seen, _ = self._made.reset(seed=seed)
        self._recorder.record_video(seen["pixels"][CAMERA])
        return seen

    def step(self, action: dict[str, Any]) -> StepResult:
        seen, reward, terminated, truncated, info = self._made.step(np.asarray(action["actions"]).reshape(-1))
        scores = {"success": info["is_success"], "value": info.get("value", float(info["is_success"]))}
        self._recorder.record_video(seen["pixels"][CAMERA])
        self._recorder.record_step(reward=reward, done=terminated or truncated, **scores)
        return StepResult(obs=seen, reward=reward, done=terminated or truncated, info=scores)

    def make_obs(self, raw_obs: Any, task: dict[str, Any]) -> dict[str, Any]:
        told = {"task_description": self._made.task_description, "state": raw_obs["agent_pos"]}
        return {"images": {CAMERA: raw_obs["pixels"][CAMERA]}, **told}

    def get_step_result(self, step_result: StepResult) -> dict[str, Any]:
        return {"success": False, "value": 0.0, **step_result.info}

    def cleanup(self) -> None:
        self._made.close()

    def _env(self) -> hazard_client.RemoteEnv:
        return hazard_client.RemoteEnv(task=self._name, **self._given)
