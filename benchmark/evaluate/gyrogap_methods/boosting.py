"""Gradient-boosted trees on features, trained on cases of the benchmark's own generator with other seeds.

One classifier for each effect, for no gap and for an unknown cause (scikit-learn's HistGradientBoostingClassifier), so
that pairs are possible. Sizes come from one regressor for each effect. SETTINGS were chosen by the log loss of a
five-fold cross-validation on the training cases.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from gyrogap.physics.motion import Floats
from gyrogap.vocabulary import JUDGED_BY, PARAMETERS
from sklearn.ensemble import HistGradientBoostingClassifier, HistGradientBoostingRegressor
from sklearn.model_selection import cross_val_predict

from evaluate.gyrogap_methods.cases import Answer, PublicCase, case_features
from evaluate.gyrogap_methods.training import TrainingCase, read_training

SETTINGS = {"max_iter": 120, "learning_rate": 0.1, "max_leaf_nodes": 8, "min_samples_leaf": 5, "l2_regularization": 1.0}
NONE, UNKNOWN = "none", "unknown"
LEAST_LISTED = 0.02


class Boosted:
    """Trained classifiers and regressors."""

    def __init__(self, training: Sequence[TrainingCase], settings: dict[str, float]) -> None:
        self.names = sorted({name for case in training for name in case.features})
        features = self.rows([case.features for case in training])
        self.classifiers = {
            label: HistGradientBoostingClassifier(random_state=0, **settings).fit(features, truth)
            for label, truth in labels(training).items()
        }
        self.regressors = {
            (effect, parameter.name): _sizes(training, features, effect, parameter.name)
            for effect, parameters in PARAMETERS.items()
            for parameter in parameters
        }

    def rows(self, features: Sequence[dict[str, float]]) -> Floats:
        """Features as an array; missing ones are not a number."""
        return np.array([[each.get(name, np.nan) for name in self.names] for each in features])

    def answer(self, case: PublicCase) -> Answer:
        """Probabilities of all labels; sizes of the effects that are listed."""
        row = self.rows([case_features(case.sessions, case.simulator)])
        chances = {label: float(model.predict_proba(row)[0, 1]) for label, model in self.classifiers.items()}
        causes = [
            {"effect": label, "probability": round(chance, 4), "parameters": self._parameters(label, row)}
            for label, chance in chances.items()
            if label in PARAMETERS and chance > LEAST_LISTED
        ]
        return {"causes": causes, "none": round(chances[NONE], 4), "unknown": round(chances[UNKNOWN], 4)}

    def _parameters(self, effect: str, row: Floats) -> dict[str, float]:
        models = {name: model for (of, name), model in self.regressors.items() if of == effect and model is not None}
        return {name: model(row) for name, model in models.items()}


def labels(training: Sequence[TrainingCase]) -> dict[str, Floats]:
    """Truth by label, (cases,) of 0 and 1."""
    truths = {effect: np.array([float(effect in case.effects) for case in training]) for effect in PARAMETERS}
    rows = {NONE: "none", UNKNOWN: "outside"}
    truths |= {label: np.array([float(case.row == row) for case in training]) for label, row in rows.items()}
    return {label: truth for label, truth in truths.items() if truth.any()}


def _sizes(
    training: Sequence[TrainingCase], features: Floats, effect: str, name: str
) -> Callable[[Floats], float] | None:
    """Regressor of a parameter on a scale that is linear at 0 and logarithmic beyond the median size."""
    having = [index for index, case in enumerate(training) if name in case.effects.get(effect, {})]
    if len(having) < 10 or name in {"phase_deg", "about_deg"}:
        return None
    sizes = np.array([training[index].effects[effect][name] for index in having])
    unit = float(np.median(np.abs(sizes))) * (0.05 if name == JUDGED_BY.get(effect) else 1.0) + 1e-12
    model = HistGradientBoostingRegressor(max_iter=80, max_leaf_nodes=6, min_samples_leaf=3, random_state=0)
    model.fit(np.nan_to_num(features[having]), np.arcsinh(sizes / unit))
    return lambda row: float(unit * np.sinh(model.predict(np.nan_to_num(row))[0]))


def cross_validated_log_loss(training: Sequence[TrainingCase], settings: dict[str, float]) -> float:
    """Mean log loss of all labels over five folds."""
    names = sorted({name for case in training for name in case.features})
    features = np.array([[case.features.get(name, np.nan) for name in names] for case in training])
    losses = []
    for truth in labels(training).values():
        model = HistGradientBoostingClassifier(random_state=0, **settings)
        chance = np.clip(
            cross_val_predict(model, features, truth, cv=5, method="predict_proba")[:, 1], 1e-6, 1.0 - 1e-6
        )
        losses.append(-np.mean(truth * np.log(chance) + (1.0 - truth) * np.log(1.0 - chance)))
    return float(np.mean(losses))


def trained(path: Path) -> Callable[[PublicCase], Answer]:
    """The method, trained on the cases of a file."""
    return Boosted(read_training(path), SETTINGS).answer
