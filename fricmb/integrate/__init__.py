"""Integrators over arrays: depends on nothing above, and could be shipped without the rest of fricmb.

A scene is seen as a :class:`Problem`; an :class:`Integrator` runs it and returns a :class:`Trajectory`.
"""

import lazy_loader as lazy

__getattr__, __dir__, __all__ = lazy.attach(
    __name__,
    submod_attrs={
        "select": ["choose"],
        "named": ["integrators"],
        "integrator": ["Integrator", "Tolerance"],
        "methods.one_step": ["OneStepMethod"],
        "event_kinds": ["EVENT_KINDS"],
        "problem": [
            "OPEN",
            "SLIP",
            "STICK",
            "Contacts",
            "Elements",
            "Linear",
            "Problem",
            "Signals",
            "Start",
            "Templates",
        ],
        "trajectory": ["Counters", "MotionSamples", "Samples", "Trajectory", "Transitions"],
    },
)
