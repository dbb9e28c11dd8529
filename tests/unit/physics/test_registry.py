from __future__ import annotations

import doctest
import sys
from dataclasses import FrozenInstanceError
from pathlib import Path

import numpy as np
import pytest

import curlshot.physics.ice
import curlshot.physics.registry
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Fit, IceLaw, Penner
from curlshot.physics.impact import Frictional, PointMass, RigidBody
from curlshot.physics.registry import FAMILIES, model, models, parameters_of


def test_all_models_are_found_by_name() -> None:
    assert models("ice") == {"constant": Constant, "fcv1": FCV1, "fit": Fit, "penner": Penner}
    assert models("curl") == {"none": NoCurl, "fcv1": FCV1Curl}
    assert models("impact") == {
        "point-mass": PointMass,
        "rigid-body": RigidBody,
        "frictional": Frictional,
    }


def test_a_model_with_its_parameters() -> None:
    assert model("ice", "constant", friction=0.02) == Constant(0.02)
    assert model("curl", "none") == NoCurl()
    for wrong in (
        lambda: models("snow"),
        lambda: model("ice", "snow"),
        lambda: model("ice", "fcv1", friction=0.01),
        lambda: model("curl", "none", turn=1.0),
    ):
        with pytest.raises(ValueError, match=r"snow|has"):
            wrong()


@pytest.mark.parametrize("family", FAMILIES)
def test_every_model_is_a_frozen_value_with_bounds(family: str) -> None:
    for name, kind in models(family).items():
        assert kind.name == name
        assert kind() == kind()
        assert hash(kind()) == hash(kind())
        for item in parameters_of(kind):
            assert item.metadata["low"] <= item.default <= item.metadata["high"]
            with pytest.raises(FrozenInstanceError):
                setattr(kind(), item.name, 0.5)


def test_a_new_file_is_a_new_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "sand.py").write_text(
        "from dataclasses import dataclass\n\n\n"
        "@dataclass(frozen=True)\nclass Sand:\n    grain: float = 1.0\n    name = 'sand'\n"
    )
    monkeypatch.setattr(
        curlshot.physics.ice, "__path__", [*curlshot.physics.ice.__path__, str(tmp_path)]
    )
    models.cache_clear()
    try:
        assert model("ice", "sand", grain=2.0).grain == 2.0
    finally:
        models.cache_clear()
        sys.modules.pop("curlshot.physics.ice.sand")


def test_examples_in_the_documentation() -> None:
    assert doctest.testmod(curlshot.physics.registry).failed == 0


@pytest.mark.parametrize("kind", models("ice").values())
def test_ice_with_more_friction_is_of_the_same_law(kind: type[IceLaw]) -> None:
    """So that a shot on it can be written by the law's name and read again."""
    law, speeds = kind(), np.array([0.05, 0.3, 1.0, 3.0])
    more = law.scaled(1.3)
    assert type(more) is kind
    assert more.deceleration(speeds) == pytest.approx(1.3 * law.deceleration(speeds), rel=1e-12)
