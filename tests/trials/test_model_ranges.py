"""Ranges of the crowd models: every model has one, and a trial beyond it gets one sentence for each limit."""

from crowdbot import models
from crowdbot.core import builtin_classes, kebab_case
from crowdbot.models import ORCA, CollisionFreeSpeed, CrowdModel, Mixture
from crowdbot.trials import MODEL_RANGES, Crowds, model_range, parse_trial, trial_remarks

TEXT = """<trial name="hall" duration="5" step="{step}" substeps="{substeps}">
  <stage walkable="0,0 20,0 20,5 0,5"/>
  <crowd type="{model}"/>
  <spawner count="{count}" zone="1,0.5 19,0.5 19,4.5 1,4.5" goal="18,1 19,1 19,4 18,4"/>
</trial>"""


def remarks(model, step="0.05", substeps="1", count="20"):
    text = TEXT.format(model=model, step=step, substeps=substeps, count=count)
    return trial_remarks(parse_trial(text, place="hall.xml"))


def test_every_builtin_model_has_a_range_with_sources():
    built_in = {*builtin_classes(models, CrowdModel)} - {kebab_case(Mixture.__name__)}
    assert built_in <= {item.model for item in MODEL_RANGES}
    assert len({item.model for item in MODEL_RANGES}) == len(MODEL_RANGES)
    for item in MODEL_RANGES:
        assert item.max_density > 0.0
        assert item.max_step > 0.0
        assert all((item.why, item.density_source, item.step_source))


def test_a_trial_within_the_range_has_no_remark():
    assert remarks("orca") == []
    assert remarks("collision-free-speed", substeps="5") == []


def test_a_coarse_step_is_named_with_the_substeps_that_help():
    (sentence,) = remarks("collision-free-speed")
    assert sentence == (
        "crowd model collision-free-speed is used with a time step of 0.05 s, beyond its range of 0.01 s"
        ' (JuPedSim 1.4.2, default time step); write substeps="5"'
    )


def test_a_dense_trial_is_named_with_what_happens():
    (sentence,) = remarks("orca", count="100")
    assert sentence.startswith("crowd model orca is used at 1 people/m2, beyond its range of 0.7: no fundamental")


def test_crowds_and_own_models():
    crowds = Crowds((ORCA(), CollisionFreeSpeed()), names=("a", "b"))
    assert [model_range(model).model for model in crowds.models] == ["orca", "collision-free-speed"]

    class Orca(ORCA):
        """Own model with the name of a built-in one."""

    assert model_range(Orca()) is None


def test_both_limits_are_separate_sentences():
    found = remarks("anticipation-velocity", count="100")
    assert len(found) == 2
    assert all("anticipation-velocity" in sentence for sentence in found)
