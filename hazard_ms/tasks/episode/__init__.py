"""Course of episodes: hazards, damage, the hand, rescues and rewards, and how all of them are saved and restored."""
