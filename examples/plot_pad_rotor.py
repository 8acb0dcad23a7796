"""
How many modes, how many contacts
=================================

A pad presses on a slowing rotor; both are elastic in their plane, given by modes of finite element models
(:func:`fricmb.models.pad_rotor`).  What do the number of modes and the number of contacts change: the transitions, the
time to stop, the spectrum of the train of impulses that stick and slip give the pad?
"""

import matplotlib.pyplot as plt
import numpy as np

import fricmb as fm

t_end, speed, mu, load = 7e-3, 0.2, 0.4, 2000.0
t = np.arange(0.0, t_end, 2e-6)
choices = {  # pad modes, rotor modes, contacts
    "3 + 0 modes, 1 contact": (3, 0, 1),
    "3 + 4 modes, 1 contact": (3, 4, 1),
    "6 + 8 modes, 1 contact": (6, 8, 1),
    "12 + 16 modes, 1 contact": (12, 16, 1),
    "3 + 4 modes, 2 contacts": (3, 4, 2),
    "6 + 8 modes, 2 contacts": (6, 8, 2),
}
runs = {}
for label, numbers in choices.items():
    scene = fm.models.pad_rotor(*numbers, speed=speed, normal_force=load, mu_s=0.5, mu_k=mu)
    runs[label] = fm.simulate(scene, t_end=t_end, rtol=1e-5, t_eval=t)

# %%
# One contact holds one point of the pad: it sticks and slips some ten times before the rotor stops, and every mode
# that is added moves the transitions a little.  Two contacts do not stick before the rotor stops.

figure, axes = plt.subplots(2, 1, figsize=(7, 6.5), layout="constrained")
for label, sol in runs.items():
    force = sum(sol.force(name)[0] for name in sol.contact_names)
    axes[0].plot(1e3 * t, sol.velocity("pad.p1.x"), lw=0.8, label=f"{label}: {len(sol.events)} transitions")
    window = np.hanning(t.size)
    impulses = np.abs(np.fft.rfft((force - force.mean()) * window)) / window.sum()
    axes[1].semilogy(np.fft.rfftfreq(t.size, t[1]) / 1e3, impulses, lw=0.8)
axes[0].set(xlabel="t (ms)", ylabel="pad at contact 1, tangential (m/s)")
figure.legend(*axes[0].get_legend_handles_labels(), fontsize="x-small", loc="outside upper center", ncols=2)
axes[1].set(xlabel="frequency (kHz)", ylabel="friction force (N)", xlim=(0, 25), ylim=(1e-3, 1e3))
plt.show()

# %%
# Sticking and slipping gives the force of one contact a train of impulses that repeats some two thousand times a
# second, near the second frequency of the pad (2.2 kHz), with peaks at its multiples; more modes raise the level
# between them.  A force that only turns its direction, as that of two contacts, has none of that.

# %%
# The time to stop hardly feels any of it.  A rigid pad that slides gives v J/(mu N r^2), with the generalised inertia
# of the rotor's rotation.

for label, sol in runs.items():
    rotation = sol.velocity("rotor.mode1")
    stopped = np.flatnonzero(rotation <= 0.0)
    lost = 1.0 - rotation[-1] / rotation[0]
    when = f"stops at {1e3 * t[stopped[0]]:.2f} ms" if stopped.size else f"has lost {lost:.0%} of its speed"
    print(f"{label:26s} {len(sol.events):3d} transitions, {when}")

sliding = runs["3 + 4 modes, 2 contacts"]
pull = sum(
    contact.normal_force * sliding.scene["rotor"].shapes[name][0, 0]
    for contact, name in zip(sliding.scene.contacts, ("p1", "p2"), strict=True)
)
rigid = sliding.velocity("rotor.mode1")[0] / (mu * pull)
rotation = sliding.velocity("rotor.mode1")
found = t[np.flatnonzero(rotation <= 0.05 * rotation[0])[0]]
assert abs(found / (0.95 * rigid) - 1.0) < 0.02
assert len(runs["3 + 4 modes, 1 contact"].events) > 10 * max(len(sliding.events), 1)
