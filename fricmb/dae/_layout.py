"""Where the stepper keeps things: the names of the entries of its three arrays, and the codes it speaks in.

The stepper is one compiled kernel that never calls the user.  It returns a *request* (evaluate the residual, factor,
...), is served by Python or by the compiled loop, and is called again.  All its memory is in three arrays:
``whole`` (int64), ``real`` (float64) and ``rows`` (float64, one row of length n for each vector).
"""

from __future__ import annotations

from typing import Final

MAX_ORDER: Final = 5

# requests of the stepper; below 0: it gave up, and why
RESIDUAL: Final = 1  # evaluate F, solve with the factors at hand
FACTOR: Final = 2  # factor dF/dy + c dF/dyp with the Jacobians at hand, then as RESIDUAL
JACOBIAN: Final = 3  # evaluate the Jacobians anew, then as FACTOR
ACCEPTED: Final = 4  # a step was made
FINISHED: Final = 5  # the end was reached (said by the loop, not by the stepper)
FULL: Final = 6  # no space to record (likewise)
FAILED_ERROR: Final = -1
FAILED_NEWTON: Final = -2
FAILED_NONFINITE: Final = -3
FAILED_SINGULAR: Final = -4

# how a request was served
SERVED: Final = 0
NONFINITE: Final = 1
SINGULAR: Final = 2

# whole
AT_START: Final = 0  # 1: the next call begins a step; 0: inside a Newton iteration
ORDER: Final = 1
ORDER_USED: Final = 2
ORDER_LIMIT: Final = 3
POINTS: Final = 4  # number of valid rows of the history
RISING: Final = 5  # 1: start, where order and step rise at every step
SAME: Final = 6  # steps since order or step size last changed
ITERATION: Final = 7
ERROR_FAILS: Final = 8  # in this step
NEWTON_FAILS: Final = 9
FRESH: Final = 10  # 1: the Jacobians were evaluated in this step
HAVE_FACTORS: Final = 11
FIRST: Final = 12  # 1: no step was made since the (re)start
JACOBIAN_AGE: Final = 13  # steps since the Jacobians were evaluated
STEPS: Final = 14
REJECTED: Final = 15
RESIDUALS: Final = 16
JACOBIANS: Final = 17
FACTORS: Final = 18
LAST_CAUSE: Final = 19  # why the last attempt was rejected, a FAILED_... code
WHOLE_SIZE: Final = 24

# real
T: Final = 0
H: Final = 1  # step to try next, with sign
T_NEW: Final = 2
H_STEP: Final = 3  # step of the current attempt
T_END: Final = 4
H_MAX: Final = 5
C: Final = 6  # leading coefficient of yp = ... + C y
C_FACTOR: Final = 7  # the one that was factored
CONTRACTION: Final = 8  # rate/(1 - rate) of the Newton iteration
NORM_FIRST: Final = 9
SCALE: Final = 10  # correction of the Newton step for C != C_FACTOR
AGO: Final = 16  # AGO + i: t_n - t_(n-i), i = 0..MAX_ORDER + 1
STAR: Final = 24  # STAR + j: factor that carries history row j to the new step size
GAMMA: Final = 32  # derivative weights of the predictor
SIGMA: Final = 40  # weights of the error estimates at constant step
REAL_SIZE: Final = 48

# rows
Y: Final = 0
YP: Final = 1
CHANGE: Final = 2  # y - predicted y
DELTA: Final = 3  # residual, then Newton step
WEIGHT: Final = 4
YP_LAST: Final = 5  # yp at the last accepted point
HISTORY: Final = 6  # HISTORY + j, j = 0..MAX_ORDER: what the predictor of degree j - 1 missed at the last point
ROWS: Final = HISTORY + MAX_ORDER + 1
