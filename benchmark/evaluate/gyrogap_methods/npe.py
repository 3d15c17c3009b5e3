"""Neural posterior estimation (`sbi`, NPE) over the sizes of all effects, with its misspecification test.

Parameters are the sizes of the effects in typical sizes, 0 for an effect that is not there; data are the features of a
case, standardized. An effect is there in a sample of the posterior if its size is above PRESENT. The answer is unknown
if the maximum mean discrepancy between the features of the case and those of training is above its 95 % quantile.
Training leaves out the effects outside of the vocabulary: the model has no place for them.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import torch
from gyrogap.physics.motion import Floats
from gyrogap.physics.sizes import STRENGTHS
from gyrogap.physics.three_axis_effects import THREE_AXIS_STRENGTHS
from gyrogap.vocabulary import PARAMETERS
from sbi.diagnostics.misspecification import calc_misspecification_mmd
from sbi.inference import NPE
from sbi.utils import BoxUniform

from evaluate.gyrogap_methods.cases import Answer, PublicCase, case_features
from evaluate.gyrogap_methods.training import TrainingCase, read_training

SIZED = STRENGTHS | THREE_AXIS_STRENGTHS
PRESENT = 0.25
JITTER = 0.05
"""Spread of the noise that is added to the parameters, so that an effect that is not there has a density."""

SAMPLES = 1000
MISSPECIFIED_BELOW = 0.05
BOUND = 12.0
LARGEST_FEATURE = 10.0
"""Standardized features are clipped here."""


def relative_size(effect: str, strength: float) -> float:
    """Size in typical sizes, compressed beyond 1; for effects whose number falls with the size, by its inverse."""
    sizes = SIZED[effect].sizes
    ratio = sizes[1] / strength if sizes[0] > sizes[-1] else strength / sizes[1]
    return float(np.arcsinh(ratio))


def strength_of(effect: str, size: float) -> float:
    """Strength from a size: the inverse of `relative_size`."""
    sizes, ratio = SIZED[effect].sizes, float(np.sinh(size))
    return sizes[1] / max(abs(ratio), 1e-3) if sizes[0] > sizes[-1] else sizes[1] * ratio


class Estimated:
    """A trained estimator of the posterior."""

    def __init__(self, training: Sequence[TrainingCase]) -> None:
        torch.manual_seed(0)
        torch.set_num_threads(1)
        known = [case for case in training if case.row != "outside"]
        self.names = sorted({name for case in known for name in case.features})
        raw = self._raw([case.features for case in known])
        self.center, self.scale = np.nanmean(raw, axis=0), np.nanstd(raw, axis=0) + 1e-9
        self.data = self._standard(raw)
        theta = np.random.default_rng(0).normal(0.0, JITTER, (len(known), len(PARAMETERS)))
        for index, case in enumerate(known):
            for column, effect in enumerate(PARAMETERS):
                if effect in case.effects:
                    theta[index, column] += relative_size(effect, case.effects[effect][SIZED[effect].parameter])
        box = BoxUniform(-BOUND * torch.ones(len(PARAMETERS)), BOUND * torch.ones(len(PARAMETERS)))
        self.inference = NPE(prior=box, density_estimator="maf", show_progress_bars=False)
        self.inference.append_simulations(torch.tensor(theta, dtype=torch.float32), self.data)
        self.estimator = self.inference.train(training_batch_size=50, max_num_epochs=200)

    def answer(self, case: PublicCase) -> Answer:
        """Shares of samples of the posterior in which an effect is there, and the misspecification test."""
        observed = self._standard(self._raw([case_features(case.sessions, case.simulator)]))
        with torch.no_grad():
            samples = self.estimator.sample((SAMPLES,), condition=observed).reshape(SAMPLES, -1).numpy()
        p_value, _ = calc_misspecification_mmd(
            inference=self.inference, x_obs=observed, x=self.data, mode="x_space", n_shuffle=200
        )
        present = np.abs(samples) > PRESENT
        causes = [
            {"effect": effect, "probability": round(float(share), 4), "parameters": self._size(effect, values)}
            for effect, share, values in zip(PARAMETERS, present.mean(axis=0), samples.T, strict=True)
            if share > 0.02
        ]
        none = float((~present).all(axis=1).mean())
        unknown = 0.9 if float(p_value) < MISSPECIFIED_BELOW else 0.05
        return {"causes": causes, "none": round(none, 4), "unknown": unknown}

    @staticmethod
    def _size(effect: str, values: Floats) -> dict[str, float]:
        there = values[np.abs(values) > PRESENT]
        return {SIZED[effect].parameter: strength_of(effect, float(np.median(there)))}

    def _raw(self, features: Sequence[dict[str, float]]) -> Floats:
        return np.array([[of_case.get(name, np.nan) for name in self.names] for of_case in features])

    def _standard(self, raw: Floats) -> torch.Tensor:
        standard = np.nan_to_num((raw - self.center) / self.scale)
        return torch.tensor(np.clip(standard, -LARGEST_FEATURE, LARGEST_FEATURE), dtype=torch.float32)


def trained(path: Path) -> Callable[[PublicCase], Answer]:
    """The method, trained on the cases of a file."""
    return Estimated(read_training(path)).answer
