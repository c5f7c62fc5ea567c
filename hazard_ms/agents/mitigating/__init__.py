"""What agents share that do something about the hazard itself: which measures there are, and how they are done."""
