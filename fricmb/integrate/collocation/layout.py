"""Names of the places in the arrays of a run (see :class:`Run`)."""

# blk[z, ., j]: v' = -W2 u - DAMP v
W2, DAMP = 0, 1
# mat[z, ., :, :]: displacement and velocity (dof, block) by block states; block inputs per force and per velocity
Q_U, Q_V, V_U, V_V, FORCE_0, FORCE_1, START_0, START_1 = range(8)
# co[., a, :]: outputs (g) by block states; ci[., a, :]: block inputs of the forces; row[., a, :]: held force by block
# states, W and M^-1 W by dofs; linked[a, b]: whether input b reaches output a
C0, C1 = range(2)
B0, B1 = range(2)
S0, S1, WT, MW = range(4)
# dof[., i, j] and vec[., i]: loads are LOAD_0 + LOAD_1 t; STUCK_V: velocity of the stuck motion
STIFF, VISC, MINV = range(3)
LOAD_0, LOAD_1, STUCK_V = range(3)
# con[., a, b]: W^T M^-1 W and its inverse
D, D_INV = range(2)
# lim: mu_s N, mu_0 N, the fastest frequency, then w
MU_S_N, MU_0_N, FASTEST, BELT = range(4)
# flags: number of rows, blocks in stick, whether blocks are modes in slip and in stick, whether rows are linked
ROWS, STUCK_BLOCKS, MODAL, STUCK_MODAL, COUPLED = range(5)
# nd[VECTORS, .]: nodes, weights, Legendre tails; the other planes are matrices
VECTORS, WITH_START, MONOMIAL, TABLEAU = range(4)
NODE, WEIGHT, TAIL, TAIL_BEFORE, TAIL_START = range(5)
# cx[., e, :]: eigenvalues of the tableau, its vectors, their inverse
LAM, VECTOR, INVERSE = range(3)
# tb[slot, ., j, :]: S, IS, IIS at the nodes; end answers of v, u and u's integral to a force on v
S, IS, IIS, Q1, Q2, Q3 = range(6)
# bx[., j]: block states with low part, loads (e0 = E0 + E1 t), accelerations, end of the step; FORCE, RATE: by dofs
U, U_LOW, V, A, K, LOAD, SLOPE, E0, E1, U_END, LOW_END, V_END, FORCE, RATE = range(14)
# nx[., a, i]: without friction, direction, with friction
FREE, DIRECTION, RELATIVE = range(3)
# wk[.]: Jacobian; Radau block; vectors: right-hand side, coefficients, results (3), signal changes per impulse on a row
JACOBIAN, RADAU, LINES = range(3)
RHS, COEFFICIENTS, OUT, CHANGE = 0, 1, 2, 5
# sd[., i], sm[., a]: the state between phases
POS, POS_LOW, VEL, SCALE = range(4)
G, N = 0, 1
# sx: time with its low part, friction loss, next step, first step of a slip
TIME, TIME_LOW, LOSS, NEXT, FIRST = range(5)
# si: counts
MODE, N_ROWS, N_PHASES, N_EVENTS, N_STEPS, N_REJECTED, N_ITERATIONS, N_BUILDS = range(8)
# steps[row, .], then u, v, a (n each), F (m s), power (s+1); phases[row, .]: q, low (n each), time, then slopes, e0, e1
AT_TIME, AT_LOW, AT_LENGTH, AT_LOSS, AT_BLOCKS = range(5)
