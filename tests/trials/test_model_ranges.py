"""Ranges of the crowd models: every model has one, and a trial beyond it gets one sentence for each limit."""

from crowdbot import models
from crowdbot.core import builtin_classes
from crowdbot.models import ORCA, CrowdModel, Mixture, with_headway
from crowdbot.trials import parse_trial, trial_remarks

TEXT = """<trial name="hall" duration="5" step="{step}" substeps="{substeps}">
  <stage walkable="0,0 20,0 20,5 0,5"/>
  <crowd type="{model}"/>
  <spawner count="{count}" zone="1,0.5 19,0.5 19,4.5 1,4.5" goal="18,1 19,1 19,4 18,4"/>
</trial>"""


def remarks(model, step="0.05", substeps="1", count="20"):
    text = TEXT.format(model=model, step=step, substeps=substeps, count=count)
    return trial_remarks(parse_trial(text, place="hall.xml"))


def test_every_builtin_model_has_a_range_with_sources():
    kinds = [kind for kind in builtin_classes(models, CrowdModel).values() if kind is not Mixture]
    for kind in kinds:
        bounds = kind.valid_range
        assert bounds is not None, kind
        assert bounds.max_density > 0.0
        assert bounds.max_step > 0.0
        assert all((bounds.why, bounds.density_source, bounds.step_source))
    assert len(kinds) >= 20


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


def test_an_own_model_with_the_name_of_a_builtin_one_has_no_range():
    class Orca(ORCA):
        """Own model with the name of a built-in one."""

    assert Orca().valid_range is None
    assert with_headway(ORCA)().valid_range is None


CROWDS = """<crowd name="a" type="orca" time-horizon="uniform(1, 3)"/>
  <crowd name="b" type="orca"/>
  <crowd name="c" type="collision-free-speed"/>"""


def test_each_model_of_several_crowds_is_named_once():
    text = TEXT.format(model="orca", step="0.4", substeps="1", count="5").replace('<crowd type="orca"/>', CROWDS)
    text = text.replace("<spawner", '<recording period="0.4"/><spawner crowd="a"')
    found = trial_remarks(parse_trial(text, place="hall.xml"))
    assert [sentence.split(" is used")[0] for sentence in found] == [
        "crowd model orca",
        "crowd model collision-free-speed",
    ]


def test_both_limits_are_separate_sentences():
    found = remarks("anticipation-velocity", count="100")
    assert len(found) == 2
    assert all("anticipation-velocity" in sentence for sentence in found)
