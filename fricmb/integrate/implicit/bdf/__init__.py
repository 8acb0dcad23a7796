"""Steps of BDF: one stage of the same equations, from what the formula keeps of the past."""
