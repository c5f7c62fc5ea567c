"""Our policies as Stable-Baselines3 trains them: choices and the value of what is seen, of the same features."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import torch
from sb3_contrib.common.maskable.distributions import MaskableDistribution
from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
from stable_baselines3.common.type_aliases import Schedule
from torch import Tensor, nn

from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape


class ActorCritic(MaskableActorCriticPolicy):
    """A policy, `chooser`, for MaskablePPO. The value is a network of its features, and is not shipped."""

    chooser: SetPolicy | MapPolicy
    worth: nn.Module

    def __init__(
        self,
        observation_space: gym.Space,
        action_space: gym.Space,
        lr_schedule: Schedule,
        shape: Shape | MapShape,
    ):
        """Make an untrained policy of `shape`; the other arguments are Stable-Baselines3's."""
        self._shape = shape
        super().__init__(observation_space, action_space, lr_schedule, ortho_init=False)

    def _build(self, lr_schedule: Schedule) -> None:
        width = self._shape.width
        if isinstance(self._shape, MapShape):
            self.chooser, self.worth = MapPolicy(self._shape), nn.Linear(width, 1)
        else:
            self.chooser = SetPolicy(self._shape)
            self.worth = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, 1))
        settings = {"lr": lr_schedule(1.0), **self.optimizer_kwargs}
        self.optimizer = self.optimizer_class(self.parameters(), **settings)

    def _asked(self, obs: Tensor, masks: Any) -> tuple[MaskableDistribution, Tensor]:
        """The distribution over choices and the value [N, 1] at `obs` [N, ...]; `masks` [N, A]; None: all allowed."""
        shape = (len(obs), int(self.action_space.n))  # type: ignore[attr-defined]
        mask = torch.ones(shape, dtype=torch.bool) if masks is None else torch.as_tensor(masks).bool().view(shape)
        if isinstance(self.chooser, MapPolicy):
            features = self.chooser.features(obs)
            logits = self.chooser.logits(features, mask)
        else:
            tokens = self.chooser.tokens(obs)
            features, logits = tokens["global"][:, 0], self.chooser.logits(tokens, mask)
        return self.action_dist.proba_distribution(action_logits=logits), self.worth(features)

    def forward(
        self, obs: Tensor, deterministic: bool = False, action_masks: Any = None
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Choices [N], values [N, 1] and logarithms of the choices' probabilities [N] at `obs` [N, ...]."""
        distribution, values = self._asked(obs, action_masks)
        actions = distribution.get_actions(deterministic=deterministic)
        return actions, values, distribution.log_prob(actions)

    def evaluate_actions(
        self, obs: Tensor, actions: Tensor, action_masks: Tensor | None = None
    ) -> tuple[Tensor, Tensor, Tensor | None]:
        """Values [N, 1], logarithms of the probabilities of `actions` [N], and entropies [N] at `obs` [N, ...]."""
        distribution, values = self._asked(obs, action_masks)
        return values, distribution.log_prob(actions), distribution.entropy()

    def get_distribution(self, obs: Any, action_masks: Any = None) -> MaskableDistribution:
        """The distribution over choices at `obs` [N, ...]."""
        return self._asked(obs, action_masks)[0]

    def predict_values(self, obs: Any) -> Tensor:
        """The values [N, 1] of `obs` [N, ...]."""
        return self._asked(obs, None)[1]
