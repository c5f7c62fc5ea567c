"""Agents that ask a language model behind an OpenAI-compatible address: what they tell it, and how they read it."""
