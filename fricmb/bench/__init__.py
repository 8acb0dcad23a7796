"""Error against run time, and stability: fricmb's integrators and the solvers of others on problems with known answers.

``fricmb bench`` and ``fricmb bench stability`` on the command line; here the parts of which they are made.
"""

import lazy_loader as lazy

__getattr__, __dir__, __all__ = lazy.attach(
    __name__,
    submod_attrs={
        "_case": ["SceneCase"],
        "_cell": ["Outcome", "measure_cell"],
        "_method": ["Method"],
        "_metrics": ["Metrics", "measure"],
        "_own": ["Own", "own_methods"],
        "_own_laws": ["law_costs"],
        "_reference": ["Reference", "Transitions"],
        "_report": ["page", "report", "report_body"],
        "_run": ["Run", "Setting"],
        "_scenes": ["SCENES"],
        "_startup": ["start_up_times"],
        "_store": ["Store"],
        "_suite": ["Options", "about", "fingerprint", "names", "run"],
        "_tables": ["scoreboard", "tolerance_statistic"],
    },
)
