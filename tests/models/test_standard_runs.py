"""Standard runs of all models with impacts at two tolerances, and a woodpecker that is started in many ways."""

import numpy as np
import pytest

import fricmb as fm
from fricmb.models import catalogue

WITH_IMPACTS = [name for name, model in catalogue.items() if any(joint.is_rigid for joint in model.build().joints)]


def test_models_with_impacts_are_found():
    assert {"bouncing_ball", "gear_rattle", "newtons_cradle", "pad_lift_off", "woodpecker"} <= set(WITH_IMPACTS)
    assert len(WITH_IMPACTS) >= 10


@pytest.mark.parametrize("name", WITH_IMPACTS)
def test_a_standard_run_has_the_same_events_at_two_tolerances(name):
    model = catalogue[name]
    loose, tight = (fm.simulate(model.build(), t_end=model.t_end, rtol=rtol).events for rtol in (1e-6, 1e-7))
    assert [(event.kind, event.contact) for event in loose] == [(event.kind, event.contact) for event in tight]
    assert len(loose.of(kind="impact")) > 10
    assert np.allclose(loose.t, tight.t, rtol=0, atol=1e-7 * model.t_end)


def test_an_edge_that_an_impact_leaves_at_rest_and_that_lifts_off_at_once_is_not_hit_again_there():
    """Its distance and the rate of that are round-off where the step begins, and the step may be longer than the hop.

    The other edge is on the far side of the pole by the play of the sleeve then: both are never hit together.
    """
    draw = np.random.default_rng(0)
    for _ in range(25):
        scene = fm.models.woodpecker(angle=draw.uniform(-0.21, -0.2), rate=draw.uniform(16.7, 18.0))
        hits = fm.simulate(scene, t_end=0.55, rtol=10 ** -draw.uniform(4.5, 7.0)).events.of(kind="impact")
        late = [hit for hit in hits if 0.19 < hit.t < 0.24]
        assert {hit.contact for hit in late} == {"low"}
        assert np.diff([hit.t for hit in late]).min(initial=1.0) > 1e-4
