"""The process of one rescue: its environment, its player, its pictures, and what is kept of it."""
