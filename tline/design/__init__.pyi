from tline.design.closure import closure as closure
from tline.design.flywheel import flywheel as flywheel
from tline.design.picture import plot_sizing as plot_sizing
from tline.design.relief import relief as relief
from tline.design.sizing import Sizing as Sizing
from tline.design.vessel import vessel as vessel
