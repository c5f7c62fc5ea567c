"""The intake of models that users bring: read with suspicion, turned into our frame, kept in the user's own folder."""
