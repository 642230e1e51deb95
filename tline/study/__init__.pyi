from tline.study.charts.work_precision import peers as peers, work_precision as work_precision
from tline.study.reference.lossy import lossy_response as lossy_response
