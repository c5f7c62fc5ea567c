"""The first steps: a fire rescue task with numpy observations, a random policy, and a picture at the end.

python examples/quickstart.py
"""

from __future__ import annotations

import gymnasium as gym

from hazard_ms import NumpyEnv, render_backend

FRAMES = 60  # two seconds of the episode

draws = render_backend() != "none"  # where pictures cannot be drawn, `hazard-ms doctor` says what is missing
looks = {"render_mode": "rgb_array"} if draws else {"render_backend": "none"}
env = NumpyEnv(gym.make("HazardFire-v1", obs_mode="state", **looks))

obs, info = env.reset(seed=0)
env.action_space.seed(0)
print(f"observations: {obs.dtype} {obs.shape}, actions: {env.action_space.shape}")
for _ in range(FRAMES):
    obs, reward, terminated, truncated, info = env.step(env.action_space.sample())
    if terminated or truncated:
        break
print(f"rescued {info['rescued']} of {info['targets']} targets, reward of the last frame {reward:.3f}")

if draws:
    import imageio.v3 as imageio

    imageio.imwrite("quickstart.png", env.render())
    print("picture: quickstart.png")
env.close()
