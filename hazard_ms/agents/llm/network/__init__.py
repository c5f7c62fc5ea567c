"""The way to a model's server: connections with limits on size and time, and the meaning of its errors."""
