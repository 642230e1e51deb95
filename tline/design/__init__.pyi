from tline.design.closure import closure as closure
from tline.design.columns import Peak as Peak, Separation as Separation, separation as separation
from tline.design.protection import flywheel as flywheel, relief as relief, vessel as vessel
from tline.design.sizing import Sizing as Sizing
