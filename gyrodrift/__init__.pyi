from gyrodrift.library.analyses import compare as compare
from gyrodrift.library.analyses import diagnose as diagnose
from gyrodrift.library.analyses import load_session as load_session
from gyrodrift.library.analyses import tune as tune
from gyrodrift.library.attitude import AttitudeEstimate as AttitudeEstimate
from gyrodrift.library.attitude import AttitudeEstimates as AttitudeEstimates
from gyrodrift.library.attitude import AttitudeFilter as AttitudeFilter
from gyrodrift.library.device import open_link as open_link
from gyrodrift.library.filters import Estimate as Estimate
from gyrodrift.library.filters import Estimates as Estimates
from gyrodrift.library.filters import Hdr as Hdr
from gyrodrift.library.filters import Restlevel as Restlevel
from gyrodrift.library.results import plot as plot
from gyrodrift.library.results import save as save
from gyrodrift.library.results import simulate as simulate

__version__: str
__all__ = [
    "AttitudeEstimate",
    "AttitudeEstimates",
    "AttitudeFilter",
    "Estimate",
    "Estimates",
    "Hdr",
    "Restlevel",
    "__version__",
    "compare",
    "diagnose",
    "load_session",
    "open_link",
    "plot",
    "save",
    "simulate",
    "tune",
]
