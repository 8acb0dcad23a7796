"""Trees and loops that a plan finds."""

import fricmb as fm
from fricmb.bench._size import links
from fricmb.scene import topology


def test_an_open_chain_is_a_tree():
    plan = links(4).plan()
    assert [(b.body, b.on, b.joint, b.coordinates) for b in plan.tree] == [
        ("l0", "ground", "j0", ("j0.angle",)),
        ("l1", "l0", "j1", ("j1.angle",)),
        ("l2", "l1", "j2", ("j2.angle",)),
        ("l3", "l2", "j3", ("j3.angle",)),
    ]
    assert plan.loops == ()
    assert topology(links(4)).groups == ()
    assert "l1 on l0 by j1, moves in j1.angle" in str(plan)


def test_a_loop_is_closed_by_one_joint():
    scene = fm.models.four_bar()
    plan = scene.plan()
    assert len(plan.tree) == 3
    (loop,) = plan.loops
    assert {loop.joint, *loop.along} == {joint.name for joint in scene.joints}
    assert "joints that close loops" in str(plan)


def test_andrews_has_three_loops_that_share_joints():
    scene = fm.models.andrews()
    assert [loop.joint for loop in scene.plan().loops] == ["F3", "F4", "F6"]
    assert len(topology(scene).groups) == 1


def test_loops_apart_are_groups_of_their_own():
    """Two four-bar linkages on the ground, and a free body."""
    parts = [fm.RigidBody("stone", mass=1.0, inertia=1.0, position=(0.0, 9.0))]
    for k in range(2):
        names = [f"{x}{k}" for x in "abc"]
        bars = [
            fm.RigidBody(n, mass=1.0, inertia=0.1, position=p, angle=a, points={"l": (-0.5, 0.0), "r": (0.5, 0.0)})
            for n, p, a in zip(
                names, [(5 * k, 0.5), (5 * k + 0.5, 1.0), (5 * k + 1, 0.5)], [1.5708, 0.0, 1.5708], strict=True
            )
        ]
        ends = [
            (bars[0].point("l"), fm.ground_point(5.0 * k, 0.0)), (bars[1].point("l"), bars[0].point("r")),
            (bars[2].point("r"), bars[1].point("r")), (bars[2].point("l"), fm.ground_point(5.0 * k + 1, 0.0)),
        ]  # fmt: skip
        parts += [*bars, *(fm.Revolute(f"pin{k}{i}", *end) for i, end in enumerate(ends))]
    found = topology(fm.Scene("two", parts))
    assert [set(group) for group in found.groups] == [{f"pin{k}{i}" for i in range(4)} for k in range(2)]
    assert [b.body for b in found.tree if b.joint is None] == ["stone"]


def test_a_joint_that_sees_the_ground_ties_what_it_joins():
    """Gear wheels on a carrier: the ratio holds for angles from the ground, so it makes a loop with the bearings."""
    train = fm.models.drive_train()
    (group,) = topology(train).groups
    assert {"gear", "motor bearing", "wheel bearing", "drive"} <= set(group)
