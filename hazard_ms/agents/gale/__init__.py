"""What agents know and believe of a wind that turns, and where they put things so that it leaves them."""
