"""The policy over sets as Stable-Baselines3 trains it: options and the value of what is seen, of the same tokens."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import torch
from sb3_contrib.common.maskable.distributions import MaskableDistribution
from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
from stable_baselines3.common.type_aliases import Schedule
from torch import Tensor, nn

from hazard_ms.agents.learned.set_policy import SetPolicy, Shape


class SetActorCritic(MaskableActorCriticPolicy):
    """A `SetPolicy`, `chooser`, for MaskablePPO. The value is an MLP of the whole's token, and is not shipped."""

    chooser: SetPolicy
    worth: nn.Module

    def __init__(self, observation_space: gym.Space, action_space: gym.Space, lr_schedule: Schedule, shape: Shape):
        """Make an untrained policy of `shape`; the other arguments are Stable-Baselines3's."""
        self._shape = shape
        super().__init__(observation_space, action_space, lr_schedule, ortho_init=False)

    def _build(self, lr_schedule: Schedule) -> None:
        width = self._shape.width
        self.chooser = SetPolicy(self._shape)
        self.worth = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, 1))
        settings = {"lr": lr_schedule(1.0), **self.optimizer_kwargs}
        self.optimizer = self.optimizer_class(self.parameters(), **settings)

    def _asked(self, obs: Tensor, masks: Any) -> tuple[MaskableDistribution, Tensor]:
        """The distribution over options and the value [N, 1] at `obs` [N, F]; `masks` [N, A] or None: all allowed."""
        tokens = self.chooser.tokens(obs)
        shape = (len(obs), int(self.action_space.n))  # type: ignore[attr-defined]
        mask = torch.ones(shape, dtype=torch.bool) if masks is None else torch.as_tensor(masks).bool().view(shape)
        made = self.action_dist.proba_distribution(action_logits=self.chooser.logits(tokens, mask))
        return made, self.worth(tokens["global"][:, 0])

    def forward(
        self, obs: Tensor, deterministic: bool = False, action_masks: Any = None
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Options [N], values [N, 1] and logarithms of the options' probabilities [N] at `obs` [N, F]."""
        distribution, values = self._asked(obs, action_masks)
        actions = distribution.get_actions(deterministic=deterministic)
        return actions, values, distribution.log_prob(actions)

    def evaluate_actions(
        self, obs: Tensor, actions: Tensor, action_masks: Tensor | None = None
    ) -> tuple[Tensor, Tensor, Tensor | None]:
        """Values [N, 1], logarithms of the probabilities of `actions` [N], and entropies [N] at `obs` [N, F]."""
        distribution, values = self._asked(obs, action_masks)
        return values, distribution.log_prob(actions), distribution.entropy()

    def get_distribution(self, obs: Any, action_masks: Any = None) -> MaskableDistribution:
        """The distribution over options at `obs` [N, F]."""
        return self._asked(obs, action_masks)[0]

    def predict_values(self, obs: Any) -> Tensor:
        """The values [N, 1] of `obs` [N, F]."""
        return self.worth(self.chooser.tokens(obs)["global"][:, 0])
