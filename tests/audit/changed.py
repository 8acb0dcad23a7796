"""Runs that are made wrong on purpose."""

from fricmb.integrate.trajectory import SampledTrajectory


class Changed(SampledTrajectory):
    """A run of which the values are changed before anybody sees them."""

    def __init__(self, held, change):
        self.held, self.change = held, change
        super().__init__(held.problem, change(held.rows()), held.transitions, held.counters, held.end, held.failure)

    def sample(self, t):
        return self.change(self.held.sample(t))
