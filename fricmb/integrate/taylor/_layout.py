"""Names of places in the arrays of a run (see _net)."""

# x: time; size of the present step; longest step; tolerance; totals of input and damping; end of the run; corrections
# below CUT are left out; speeds below NOISE are round-off; next step; last coefficient of a correction of this step;
# where the step ends (s) and the part of it that is good, for coupled contacts; largest speed; s up to which power
# between signals is counted
TIME, STEP, LONGEST, TOL, INPUT, DAMPING, END, CUT, NOISE, NEXT, JUMP, UNTIL, ALLOWED, FASTEST = range(14)
PAID = 14
# i: steps, shortened ones, events, samples taken, size of the heap, searches, events in this step and their limit,
# phase of the step, next stop; contacts and groups that a correction touches; steps in a row that did not move the time
N_STEPS, N_SHORTER, N_EVENTS, N_SAMPLES, N_HEAP, N_SEARCHES, N_HERE, LIMIT, PHASE, N_STOP = range(10)
N_TOUCHED, N_GROUPS, STALLED = range(10, 13)
# flat[.]: rows of work
SUM, WORK, WORK2, WORK3 = range(4)
# old[.]: polynomials of one contact: watched, shifted to where y = 0 and change of force, force before
WATCH, SHIFTED, BEFORE = range(3)
