"""Forces, constraints and friction at an instant: residuals, matrices, accelerations and reactions."""
