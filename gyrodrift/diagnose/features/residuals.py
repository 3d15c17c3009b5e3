"""Features of what is left of the rate without the encoder's: block by block, and within seconds."""

import numpy as np

from gyrodrift.diagnose.features.block_residuals import block_residuals_of
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.features.periodic import PERIODIC
from gyrodrift.diagnose.features.wander import SCATTER, WALK, WANDER
from gyrodrift.diagnose.features.warming import WARMING, warming_coefficient
from gyrodrift.diagnose.features.within_second import LAG_FEATURES, lag_coefficients
from gyrodrift.diagnose.recording.outliers import Cleaned

STATISTICS = (*WANDER, *PERIODIC, *WALK, *SCATTER)
FEATURES = (*COLUMNS, *LAG_FEATURES, WARMING, *STATISTICS)

THRESHOLDS = np.array([statistic.threshold for statistic in STATISTICS])


def measure(seen: Cleaned, design: DesignMatrix) -> Measured:
    """FEATURES of a recording or of a simulation."""
    blocks = block_residuals_of(seen, design)
    lags = lag_coefficients(seen.rate_dps, seen.encoder_deg, design.lag, design.period_s)
    warming = warming_coefficient(blocks.bias_dps, design.warming)
    others = [statistic.compute(blocks) for statistic in STATISTICS]
    thresholds = (design.static.thresholds, design.lag.thresholds, design.warming.thresholds, THRESHOLDS)
    return Measured(np.concatenate([blocks.static, lags, warming, others]), np.concatenate(thresholds))
