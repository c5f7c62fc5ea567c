"""Models that users bring: read with suspicion, turned into our frame, given collision shapes, kept in the user's own folder."""
