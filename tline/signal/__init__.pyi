from tline.signal.all_patterns import (
    StatisticalEye as StatisticalEye,
    best_ffe as best_ffe,
    statistical_eye as statistical_eye,
)
from tline.signal.bits import prbs as prbs, prbs7 as prbs7
from tline.signal.channel import Channel as Channel, measured_channel as measured_channel
from tline.signal.clauses import Clause as Clause, clause as clause
from tline.signal.eye_diagram import Eye as Eye, eye as eye
from tline.signal.eye_statistics import (
    Jitter as Jitter,
    Mask as Mask,
    jitter as jitter,
    mask_hits as mask_hits,
    mask_margin as mask_margin,
)
from tline.signal.load_line import Bergeron as Bergeron, LoadLine as LoadLine, bergeron as bergeron
from tline.signal.margin import OperatingMargin as OperatingMargin, operating_margin as operating_margin
from tline.signal.pulse import PulseResponse as PulseResponse, pulse_response as pulse_response
from tline.signal.tdr import Reflections as Reflections, reflectometry as reflectometry
