"""Names of places in the arrays of a run (see _run)."""

# x: present time; step; end of the run; tolerance; stated residual of the contacts; longest and shortest step; fixed
# step or 0; error of the last step; change of the lagged terms that is none; relative velocities below NOISE are
# round-off; whether the run goes on from another; leeway of steps with transitions;
# whether a coefficient of friction is negative where a step ends
TIME, STEP, END, TOL, RESIDUAL, LONGEST, SHORTEST, FIXED, ERROR, SETTLED, NOISE, SAME, LEEWAY, FAULT = range(14)
# what FAULT says: nothing; the coefficient is negative; a coefficient or normal force is no number
SOUND, DRIVES, NO_NUMBER = 0.0, 1.0, 2.0
# i: accepted and rejected steps; rounds, Newton iterations, factorisations; rows and events so far; next stop;
# whether the contacts are solved condensed; half band width; whether normal forces vary; steps not settled
N_STEPS, N_REJECTED, N_ROUNDS, N_NEWTON, N_FACTOR, N_ROWS, N_EVENTS, N_STOP, CONDENSED, BAND, VARYING, N_UNSETTLED = (
    range(12)
)
# status of a contact in a step: was slipping and goes on; was stuck; broke away; comes to rest; passes through zero
FREE, HELD, BROKEN, CAUGHT, PASSED = range(5)
# slots of the state: start of the step, end of the whole step, middle and end by two halves
HERE, WHOLE, MIDDLE, THERE = range(4)
# columns of the largest values of a part
POSITION, VELOCITY, LIMIT = range(3)
