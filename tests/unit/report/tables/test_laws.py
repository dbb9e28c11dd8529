from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from curlshot.report import tables


def test_laws_stand_beside_the_literature_for_curling_stones_only(shot):
    table = tables.law_table(shot.results)
    assert table["symbol"].tolist() == ["e", "μ", "μₛ"]
    assert table["value"].tolist() == pytest.approx([0.8312345, 0.01093456, 0.05])
    assert table["stderr"].iloc[2] == pytest.approx(0.01)
    assert table["literature"].iloc[0] == 0.83
    pucks = tables.law_table(dataclasses.replace(shot.results, radius=0.035))
    assert pucks[["literature", "low"]].isna().all().all()


def test_methods_laws_and_stones_are_listed(shot):
    methods = tables.method_table(shot.results).set_index("method")
    assert methods.loc["local", "hit 1"] == 0.83
    assert np.isnan(methods.loc["shot_fit", "hit 2"])
    assert methods.loc["shot_fit", "note"] == "one fit"
    choices = tables.choice_table(shot.results)
    assert choices["laws"].tolist() == ["ice constant", "ice fit"]
    assert choices["weight"].sum() == pytest.approx(1.0)
    (ice,) = tables.ice_table(shot.results).to_dict("records")
    assert (ice["stone"], ice["friction"], ice["sd_spin"]) == ("A", 0.0112, 0.01)
